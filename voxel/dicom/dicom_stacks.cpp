// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/dicom_stacks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "voxel/space/printed.h"

namespace octotomy::voxel {

namespace {

/// Files state positions to a hundredth of a millimetre or better. Images closer than this count as being at
/// one position.
constexpr double same_place_mm() {
  return 0.01;
}

/// Two spacings or directions count as equal if their difference shifts no pixel by more than half its width;
/// their mean then shifts none by more than a quarter. Smaller differences come from rounding of decimals,
/// and from writers that recompute the values for each slice.
constexpr double same_pixel_px() {
  return 0.5;
}

/// Rounding to three decimals changes directions by at most this angle in radians. A larger angle between
/// images is real, even if it moves the pixels of a small image by less than half a pixel.
constexpr double cosine_tolerance() {
  return 2e-3;
}

/// Pairs of different images at one position, sorted by their heights along the normal.
std::vector<std::pair<std::size_t, std::size_t>> rivals_of(const std::vector<DicomSlice>& slices) {
  if (slices.empty()) return {};
  const glm::dvec3 normal = glm::cross(slices.front().along_row, slices.front().along_column);
  std::vector<std::pair<double, std::size_t>> heights;
  for (std::size_t i = 0; i < slices.size(); ++i)
    heights.emplace_back(glm::dot(slices[i].first_mm, normal), i);
  std::sort(heights.begin(), heights.end());
  std::vector<std::pair<std::size_t, std::size_t>> rivals;
  for (std::size_t i = 1; i < heights.size(); ++i) {
    const DicomSlice& below = slices[heights[i - 1].second];
    const DicomSlice& above = slices[heights[i].second];
    if (heights[i].first - heights[i - 1].first < same_place_mm() && below.instance_uid != above.instance_uid)
      rivals.emplace_back(heights[i - 1].second, heights[i].second);
  }
  return rivals;
}

/// The attribute in which the largest number of pairs of rivals differ; none if this is less than half of the
/// pairs.
std::optional<std::size_t> parting_trait(const std::vector<DicomSlice>& slices,
                                         const std::vector<std::pair<std::size_t, std::size_t>>& rivals) {
  std::size_t most = 0;
  std::optional<std::size_t> best;
  for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait) {
    if (dicom_traits[trait].role != TraitRole::Stack) continue;
    const auto parted =
        static_cast<std::size_t>(std::count_if(rivals.begin(), rivals.end(), [&](const auto& pair) {
          return slices[pair.first].traits[trait] != slices[pair.second].traits[trait];
        }));
    if (parted > most) {
      most = parted;
      best = trait;
    }
  }
  return 2 * most >= rivals.size() ? best : std::nullopt;
}

/// The index of the trait that orders images in time.
std::size_t time_trait() {
  std::size_t trait = 0;
  while (dicom_traits[trait].role != TraitRole::Order) ++trait;
  return trait;
}

/// If nearly every position has several images, splits them into the first images of all positions, the
/// second ones, and so on. Images at a position are ordered by time, or by number if their times are equal.
/// If neither differs, the images are not split.
std::vector<std::vector<DicomSlice>> parted_by_order(std::vector<DicomSlice> slices) {
  const glm::dvec3 normal = glm::cross(slices.front().along_row, slices.front().along_column);
  const std::size_t time = time_trait();
  std::stable_sort(slices.begin(), slices.end(), [&](const DicomSlice& a, const DicomSlice& b) {
    return glm::dot(a.first_mm, normal) < glm::dot(b.first_mm, normal);
  });
  // For each position, the index of its first image and one past that of its last.
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (std::size_t i = 0; i < slices.size(); ++i)
    if (i > 0 && glm::dot(slices[i].first_mm - slices[i - 1].first_mm, normal) < same_place_mm())
      places.back().second = i + 1;
    else
      places.emplace_back(i, i + 1);
  const auto count_where = [&](const auto& holds) {
    return static_cast<std::size_t>(std::count_if(places.begin(), places.end(), holds));
  };
  const std::size_t crowded = count_where([](const auto& at) { return at.second - at.first > 1; });
  if (places.size() < 2 || 5 * crowded < 4 * places.size()) return {std::move(slices)};
  const auto differ = [&](const auto& value) {
    return count_where([&](const auto& at) {
             std::set<std::string> values;
             for (std::size_t i = at.first; i < at.second; ++i) values.insert(value(slices[i]));
             return at.second - at.first > 1 && values.size() == at.second - at.first;
           }) == crowded;
  };
  const bool by_time = differ([&](const DicomSlice& slice) { return slice.traits[time]; });
  const auto number = [](const DicomSlice& slice) {
    return std::to_string(slice.instance_number) + "#" + std::to_string(slice.frame);
  };
  if (!by_time && !differ(number)) return {std::move(slices)};
  std::vector<std::vector<DicomSlice>> parts;
  for (const auto& [first, end] : places) {
    const auto at = [&](std::size_t i) { return slices.begin() + static_cast<std::ptrdiff_t>(i); };
    std::stable_sort(at(first), at(end), [&](const DicomSlice& a, const DicomSlice& b) {
      if (by_time) return a.traits[time] < b.traits[time];
      return std::pair(a.instance_number, a.frame) < std::pair(b.instance_number, b.frame);
    });
    if (parts.size() < end - first) parts.resize(end - first);
    for (std::size_t i = first; i < end; ++i) parts[i - first].push_back(std::move(slices[i]));
  }
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (DicomSlice& slice : parts[i])
      slice.traits[time] = print("%zu of %zu%s", i + 1, parts.size(), by_time ? "" : " by number");
  return parts;
}

void part(std::vector<DicomSlice> slices, std::vector<std::vector<DicomSlice>>& parts) {
  const auto rivals = rivals_of(slices);
  const auto trait = rivals.empty() ? std::nullopt : parting_trait(slices, rivals);
  if (!trait) {
    if (rivals.empty()) return parts.push_back(std::move(slices));
    std::vector<std::vector<DicomSlice>> ordered = parted_by_order(std::move(slices));
    std::move(ordered.begin(), ordered.end(), std::back_inserter(parts));
    return;
  }
  std::set<std::string> values;
  for (const DicomSlice& slice : slices) values.insert(slice.traits[*trait]);
  // If nearly every image has its own value, the value is a counter: it orders the images at one position and
  // identifies no stack.
  if (2 * values.size() > slices.size() && values.size() > 2) {
    std::vector<std::vector<DicomSlice>> ordered = parted_by_order(std::move(slices));
    std::move(ordered.begin(), ordered.end(), std::back_inserter(parts));
    return;
  }
  std::map<std::string, std::vector<DicomSlice>> by_value;
  for (DicomSlice& slice : slices) by_value[slice.traits[*trait]].push_back(std::move(slice));
  for (auto& [value, members] : by_value) part(std::move(members), parts);
}

const char* plane_of(const DicomSlice& slice) {
  const glm::dvec3 normal = glm::abs(glm::cross(slice.along_row, slice.along_column));
  return normal.z >= normal.x && normal.z >= normal.y ? "axial"
         : normal.y >= normal.x                       ? "coronal"
                                                      : "sagittal";
}

/// Describes how the parts differ. Leaves out identities, because a report may leave the hospital. The cost
/// is linear in the number of parts, because values that all parts share are computed once.
class Words {
 public:
  explicit Words(const std::vector<std::vector<DicomSlice>>& parts) {
    if (parts.empty()) return;
    const DicomSlice& first = parts.front().front();
    for (const std::vector<DicomSlice>& part : parts) {
      const DicomSlice& slice = part.front();
      for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait)
        trait_differs_[trait] |= slice.traits[trait] != first.traits[trait];
      plane_differs_ |= std::string(plane_of(slice)) != plane_of(first);
      size_differs_ |= slice.size_px != first.size_px;
    }
    // A part's spacing differs from that of some other part exactly if it differs from the least or the
    // largest one.
    for (int axis = 0; axis < 2; ++axis) {
      const auto [least, largest] =
          std::minmax_element(parts.begin(), parts.end(), [&](const auto& a, const auto& b) {
            return a.front().spacing_mm[axis] < b.front().spacing_mm[axis];
          });
      extremes_.push_back(&least->front());
      extremes_.push_back(&largest->front());
    }
  }

  std::string operator()(const DicomSlice& slice) const {
    std::string words;
    const auto add = [&](const std::string& text) { words += (words.empty() ? "" : ", ") + text; };
    for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait) {
      const TraitRole role = dicom_traits[trait].role;
      const std::string& value = slice.traits[trait];
      if (role == TraitRole::Uniformity || !trait_differs_[trait]) continue;
      // A time is shown only if the stacks were split by it.
      if (role == TraitRole::Order && value.find(" of ") == std::string::npos) continue;
      const bool is_shown = role == TraitRole::Stack || role == TraitRole::Order || value.size() == 2;
      if (is_shown && value.empty())
        add(std::string("no ") + dicom_traits[trait].words);
      else
        add(std::string(dicom_traits[trait].words) + (is_shown ? " " + value : " of its own"));
    }
    if (plane_differs_) add(plane_of(slice));
    if (size_differs_ || std::any_of(extremes_.begin(), extremes_.end(),
                                     [&](const DicomSlice* other) { return !same_grid(*other, slice); }))
      add(print("%d x %d pixels of %.4g mm", slice.size_px.x, slice.size_px.y, slice.spacing_mm.x));
    return words;
  }

 private:
  std::array<bool, dicom_traits.size()> trait_differs_{};
  bool plane_differs_ = false, size_differs_ = false;
  std::vector<const DicomSlice*> extremes_;
};

std::vector<DicomSubseries> sorted(std::vector<std::vector<DicomSlice>> parts) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::vector<std::string> words;
  {
    const Words of(parts);
    for (const std::vector<DicomSlice>& members : parts) words.push_back(of(members.front()));
  }
  std::vector<DicomSubseries> found;
  for (std::size_t i = 0; i < parts.size(); ++i) found.push_back({std::move(parts[i]), std::move(words[i])});
  return found;
}

bool same_identity(const DicomSlice& a, const DicomSlice& b, bool join) {
  for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait)
    if ((dicom_traits[trait].role == TraitRole::Identity ||
         (dicom_traits[trait].role == TraitRole::Origin && !join)) &&
        a.traits[trait] != b.traits[trait] && !a.traits[trait].empty() && !b.traits[trait].empty())
      return false;
  return true;
}

}  // namespace

std::vector<std::vector<DicomSlice>> grouped(
    std::vector<DicomSlice> slices, const std::function<bool(const DicomSlice&, const DicomSlice&)>& alike) {
  std::vector<std::vector<DicomSlice>> parts;
  for (DicomSlice& slice : slices) {
    const auto part = std::find_if(parts.begin(), parts.end(),
                                   [&](const auto& members) { return alike(members.front(), slice); });
    if (part == parts.end())
      parts.push_back({std::move(slice)});
    else
      part->push_back(std::move(slice));
  }
  return parts;
}

bool same_grid(const DicomSlice& a, const DicomSlice& b) {
  const glm::dvec2 shift_px = glm::abs(a.spacing_mm / b.spacing_mm - 1.0) * glm::dvec2(a.size_px);
  // Rounding of decimals changes a spacing by less than a hundredth of it, even if the image has so few
  // pixels that a larger difference moves none of them by half a pixel.
  return a.size_px == b.size_px && glm::all(glm::lessThanEqual(shift_px, glm::dvec2(same_pixel_px()))) &&
         glm::all(glm::lessThan(glm::abs(a.spacing_mm - b.spacing_mm), 1e-2 * a.spacing_mm));
}

double turned_px(const DicomSlice& slice, const glm::dvec3& along_row, const glm::dvec3& along_column) {
  const glm::dvec2 side_mm = glm::dvec2(slice.size_px) * slice.spacing_mm;
  const double shift_mm = glm::length(slice.along_row - along_row) * side_mm.x +
                          glm::length(slice.along_column - along_column) * side_mm.y;
  return shift_mm / std::min(slice.spacing_mm.x, slice.spacing_mm.y);
}

bool same_orientation(const DicomSlice& a, const DicomSlice& b) {
  return glm::length(a.along_row - b.along_row) < cosine_tolerance() &&
         glm::length(a.along_column - b.along_column) < cosine_tolerance() &&
         turned_px(a, b.along_row, b.along_column) <= same_pixel_px();
}

std::vector<DicomSubseries> parted_at_one_place(std::vector<DicomSlice> slices) {
  std::vector<std::vector<DicomSlice>> parts;
  part(std::move(slices), parts);
  return sorted(std::move(parts));
}

std::vector<DicomSubseries> subseries_of(const std::vector<DicomSlice>& series, bool join) {
  const bool is_scout_only =
      std::all_of(series.begin(), series.end(), [](const DicomSlice& slice) { return slice.is_localizer; });
  std::vector<DicomSlice> asked;
  std::copy_if(series.begin(), series.end(), std::back_inserter(asked),
               [&](const DicomSlice& slice) { return is_scout_only || !slice.is_localizer; });
  std::vector<std::vector<DicomSlice>> alike =
      grouped(std::move(asked), [&](const DicomSlice& a, const DicomSlice& b) {
        return same_grid(a, b) && same_orientation(a, b) && same_identity(a, b, join);
      });
  std::vector<std::vector<DicomSlice>> parts;
  for (std::vector<DicomSlice>& members : alike) part(std::move(members), parts);
  return sorted(std::move(parts));
}

}  // namespace octotomy::voxel
