// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/dicom_stacks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "voxel/scan/audit.h"

namespace octotomy::voxel {

namespace {

/// Files give positions to a hundredth of a millimetre or better; nearer images lie at one place.
constexpr double same_place_mm() {
  return 0.01;
}

/// Files give direction cosines with six decimals or more. Ten roundings are allowed: over the longest side
/// in use, 4096 pixels, they shift a pixel by a twenty-fifth of its width.
constexpr double cosine_tolerance() {
  return 1e-5;
}

/// Pairs of different images at one place, in the order of their heights.
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

/// The attribute that tells most rivals apart, if it does so for half of them.
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

void part(std::vector<DicomSlice> slices, std::vector<std::vector<DicomSlice>>& parts) {
  const auto rivals = rivals_of(slices);
  const auto trait = rivals.empty() ? std::nullopt : parting_trait(slices, rivals);
  if (!trait) {
    parts.push_back(std::move(slices));
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

/// What tells parts from each other. Identities are not shown: a report may leave the hospital. Linear: what
/// all parts share is found once.
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
    // A spacing differs most from the least or the largest.
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
      if (dicom_traits[trait].role == TraitRole::Uniformity || !trait_differs_[trait]) continue;
      const std::string& value = slice.traits[trait];
      const bool is_shown = dicom_traits[trait].role == TraitRole::Stack || value.size() == 2;
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

bool same_identity(const DicomSlice& a, const DicomSlice& b) {
  for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait)
    if (dicom_traits[trait].role == TraitRole::Identity && a.traits[trait] != b.traits[trait] &&
        !a.traits[trait].empty() && !b.traits[trait].empty())
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
  return a.size_px == b.size_px &&
         glm::all(glm::lessThan(glm::abs(a.spacing_mm - b.spacing_mm), 1e-5 * a.spacing_mm));
}

bool same_orientation(const DicomSlice& a, const DicomSlice& b) {
  return glm::length(a.along_row - b.along_row) < cosine_tolerance() &&
         glm::length(a.along_column - b.along_column) < cosine_tolerance();
}

std::vector<DicomSubseries> parted_at_one_place(std::vector<DicomSlice> slices) {
  std::vector<std::vector<DicomSlice>> parts;
  part(std::move(slices), parts);
  return sorted(std::move(parts));
}

std::vector<DicomSubseries> subseries_of(const std::vector<DicomSlice>& series) {
  const bool is_scout_only =
      std::all_of(series.begin(), series.end(), [](const DicomSlice& slice) { return slice.is_localizer; });
  std::vector<DicomSlice> asked;
  std::copy_if(series.begin(), series.end(), std::back_inserter(asked),
               [&](const DicomSlice& slice) { return is_scout_only || !slice.is_localizer; });
  std::vector<std::vector<DicomSlice>> alike =
      grouped(std::move(asked), [](const DicomSlice& a, const DicomSlice& b) {
        return same_grid(a, b) && same_orientation(a, b) && same_identity(a, b);
      });
  std::vector<std::vector<DicomSlice>> parts;
  for (std::vector<DicomSlice>& members : alike) part(std::move(members), parts);
  return sorted(std::move(parts));
}

}  // namespace octotomy::voxel
