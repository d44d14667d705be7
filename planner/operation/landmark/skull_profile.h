// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/landmark/head_map.h"

namespace octotomy::planner {

/// Positions in a head's frame by landmarks' names, and the reasons why others were not found.
struct FoundPlaces {
  std::map<std::string, glm::dvec3> places;
  std::map<std::string, std::string> missing;
  /// Each landmark's own doubt: the length over which its extremum is flat, and the distance to a second
  /// rule's result.
  std::map<std::string, double> doubt_mm;

  const glm::dvec3* find(const std::string& name) const {
    const auto at = places.find(name);
    return at == places.end() ? nullptr : &at->second;
  }
};

/// The skull's outline in the mid-plane, as seen from the front: the backward coordinate where bone begins,
/// by height, the highest first. Infinite where there is no bone.
struct Profile {
  double top_mm = 0.0, step_mm = 1.0;
  double cut_mm = -std::numeric_limits<double>::infinity();  ///< the height at which the scan cuts bone off
  double chin_notch_mm = 0.0;                                ///< chin_notch()
  std::vector<double> back_mm;
  std::vector<double> middle_mm;  ///< by height: the position, left of the mid-plane, about which both sides
                                  ///< are most alike

  double up_mm(int row) const { return top_mm - row * step_mm; }
  int row(double up_mm) const;
  int rows() const { return static_cast<int>(back_mm.size()); }
};
/// The foremost bone within a distance of the face's middle at each height. The middle of a crooked face lies
/// beside the mid-plane.
Profile profile_of(const HeadMap& front, double within_mm);

/// The bony opening of the nose in the mid-line: its highest and lowest height.
struct NasalOpening {
  double top_mm = 0.0, floor_mm = 0.0;
};
/// None unless an opening in the profile has bone on both sides that lies in front of the surface within it.
std::optional<NasalOpening> find_nasal_opening(const Profile& profile, const HeadMap& front);

/// The height at which the scan cuts the bone off: the lowest bone is then far too wide for an end of its
/// own.
double cut_height(const HeadMap& side);

/// The height of the chin's lower border in the middle, relative to the border beside it; negative: lower.
double chin_notch(const HeadMap& front, const Profile& profile, const NasalOpening& nose);

/// Nasion, ANS, A, the incisors' edges, B, pogonion and menton, each as the foremost, deepest or lowest point
/// of its part of the profile. A landmark without such an extremum is missing, with the reason. Teeth are
/// distinguished from a toothless ridge by the distance of their edge from spine and chin, relative to the
/// height of the nose.
FoundPlaces places_of_profile(const Profile& profile, const NasalOpening& nose);

}  // namespace octotomy::planner
