// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/landmark/head_map.h"

namespace octotomy::planner {

/// Positions of landmarks by name, in a head's frame, and the reasons why others were not found.
struct FoundPlaces {
  std::map<std::string, glm::dvec3> places;
  std::map<std::string, std::string> missing;
  /// The doubt about each landmark in mm: the length over which its extremum is flat, and the distance to the
  /// result of a second rule.
  std::map<std::string, double> doubt_mm;

  const glm::dvec3* find(const std::string& name) const {
    const auto at = places.find(name);
    return at == places.end() ? nullptr : &at->second;
  }
};

/// The outline of the skull in the mid-plane, seen from the front: for each height, the highest first, the
/// backward coordinate at which bone begins. Infinite at heights without bone.
struct Profile {
  double top_mm = 0.0, step_mm = 1.0;
  double cut_mm = -std::numeric_limits<double>::infinity();  ///< the height at which the scan cuts off the
                                                             ///< bone
  double chin_notch_mm = 0.0;                                ///< chin_notch()
  std::vector<double> back_mm;
  std::vector<double> middle_mm;  ///< for each height, the position left of the mid-plane about which the two
                                  ///< sides are most alike

  double up_mm(int row) const { return top_mm - row * step_mm; }
  int row(double up_mm) const;
  int rows() const { return static_cast<int>(back_mm.size()); }
};
/// The profile of the foremost bone within `within_mm` of the face's middle at each height. In a crooked face
/// the middle lies beside the mid-plane.
Profile profile_of(const HeadMap& front, double within_mm);

/// The bony opening of the nose in the mid-line: the heights of its top and its floor.
struct NasalOpening {
  double top_mm = 0.0, floor_mm = 0.0;
};
/// Finds the nose's opening: a gap in the profile with bone on both sides that stands in front of the surface
/// within it. None if there is none.
std::optional<NasalOpening> find_nasal_opening(const Profile& profile, const HeadMap& front);

/// The height at which the scan cuts off the bone: below it, the lowest bone is too wide to be its natural
/// end. -infinity if the scan cuts nothing off.
double cut_height(const HeadMap& side);

/// The height of the chin's lower border in the middle, relative to the border beside it; negative: lower.
double chin_notch(const HeadMap& front, const Profile& profile, const NasalOpening& nose);

/// Finds nasion, ANS, A, the incisors' edges, B, pogonion and menton, each as the foremost, deepest or lowest
/// point of its part of the profile. A landmark without such an extremum is missing, with the reason. Teeth
/// are distinguished from a toothless ridge by the distance of their edge from spine and chin, relative to
/// the height of the nose.
FoundPlaces places_of_profile(const Profile& profile, const NasalOpening& nose);

}  // namespace octotomy::planner
