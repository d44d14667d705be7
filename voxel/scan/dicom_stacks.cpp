// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/dicom_stacks.h"

#include <algorithm>
#include <cmath>
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

/// What tells parts from each other. Identities are not shown: a report may leave the hospital.
std::string words_of(const std::vector<std::vector<DicomSlice>>& parts, const DicomSlice& slice) {
  std::string words;
  const auto add = [&](const std::string& text) { words += (words.empty() ? "" : ", ") + text; };
  const auto differs = [&](const auto& of) {
    return std::any_of(parts.begin(), parts.end(),
                       [&](const auto& part) { return of(part.front()) != of(slice); });
  };
  for (std::size_t trait = 0; trait < dicom_traits.size(); ++trait) {
    const auto value = [&](const DicomSlice& of) { return of.traits[trait]; };
    if (dicom_traits[trait].role == TraitRole::Uniformity || !differs(value)) continue;
    const bool is_shown = dicom_traits[trait].role == TraitRole::Stack || value(slice).size() == 2;
    add(std::string(dicom_traits[trait].words) + (is_shown ? " " + value(slice) : " of its own"));
  }
  if (differs([](const DicomSlice& of) { return std::string(plane_of(of)); })) add(plane_of(slice));
  if (std::any_of(parts.begin(), parts.end(),
                  [&](const auto& part) { return !same_grid(part.front(), slice); }))
    add(print("%d x %d pixels of %.4g mm", slice.size_px.x, slice.size_px.y, slice.spacing_mm.x));
  return words;
}

std::vector<DicomSubseries> sorted(std::vector<std::vector<DicomSlice>> parts) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::vector<DicomSubseries> found;
  for (const std::vector<DicomSlice>& members : parts)
    found.push_back({members, words_of(parts, members.front())});
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
  std::vector<std::vector<DicomSlice>> alike;
  for (const DicomSlice& slice : series) {
    if (slice.is_localizer && !is_scout_only) continue;
    const auto group = std::find_if(alike.begin(), alike.end(), [&](const auto& members) {
      return same_grid(members.front(), slice) && same_orientation(members.front(), slice) &&
             same_identity(members.front(), slice);
    });
    if (group == alike.end())
      alike.push_back({slice});
    else
      group->push_back(slice);
  }
  std::vector<std::vector<DicomSlice>> parts;
  for (std::vector<DicomSlice>& members : alike) part(std::move(members), parts);
  return sorted(std::move(parts));
}

}  // namespace octotomy::voxel
