// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/landmark/head_map.h"

namespace octotomy::planner {

/// Places in a head's frame by landmarks' names, and why others were not found.
struct FoundPlaces {
  std::map<std::string, glm::dvec3> places;
  std::map<std::string, std::string> missing;
  /// How far each may be off for reasons of its own: the length over which its extremum is flat, and how far
  /// a second rule's answer lies away.
  std::map<std::string, double> doubt_mm;

  const glm::dvec3* find(const std::string& name) const {
    const auto at = places.find(name);
    return at == places.end() ? nullptr : &at->second;
  }
};

/// The skull's outline in the mid-plane, as seen from the front: how far back the bone begins by height, the
/// highest first. Infinite where there is none.
struct Profile {
  double top_mm = 0.0, step_mm = 1.0;
  double cut_mm = -std::numeric_limits<double>::infinity();  ///< the height at which the scan cuts bone off
  double chin_notch_mm = 0.0;                                ///< chin_notch()
  std::vector<double> back_mm;
  std::vector<double> middle_mm;  ///< left of the mid-plane, where both sides are most alike at this height

  double up_mm(int row) const { return top_mm - row * step_mm; }
  int row(double up_mm) const;
  int rows() const { return static_cast<int>(back_mm.size()); }
};
/// The foremost bone within a distance of the face's own middle at each height, which of crooked faces lies
/// beside the mid-plane.
Profile profile_of(const HeadMap& front, double within_mm);

/// The bony opening of the nose in the mid-line: its highest and lowest height.
struct NasalOpening {
  double top_mm = 0.0, floor_mm = 0.0;
};
/// None unless some opening in the profile has bone on both sides that lies before what is seen within it.
std::optional<NasalOpening> find_nasal_opening(const Profile& profile, const HeadMap& front);

/// The height below which the scan, and not the bone, ends: its lowest bone is far too wide for an end.
double cut_height(const HeadMap& side);

/// By how much the chin's lower border lies higher in the middle than beside it; negative: lower.
double chin_notch(const HeadMap& front, const Profile& profile, const NasalOpening& nose);

/// Nasion, ANS, A, the incisors' edges, B, pogonion and menton, each as the foremost, deepest or
/// lowest point of its part of the profile. What has no such extremum is missing, with the reason.
/// Teeth are told from the ridge that is left without them by how far their edge
/// lies from spine and chin, of the height of the nose.
FoundPlaces places_of_profile(const Profile& profile, const NasalOpening& nose);

}  // namespace octotomy::planner
