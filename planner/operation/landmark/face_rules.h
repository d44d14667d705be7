// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/landmark/skull_profile.h"

namespace octotomy::planner {

/// Adds the landmarks that exist on both sides, with the endings _left and _right: the piriform rims, the
/// orbits' lowest rims, the zygomatic buttresses, the outermost points of the zygomatic arches and the angles
/// of the mandible. `found` must contain the landmarks of the profile. `higher_mm` shifts the heights at
/// which the rules measure.
void find_face_places(const HeadMaps& maps, const NasalOpening& nose, double higher_mm, FoundPlaces& found);

/// Adds the point of the mid-line at the root of the nose, or the reason why it is missing.
void find_nose_root(const HeadMaps& maps, const NasalOpening& nose, FoundPlaces& found);

}  // namespace octotomy::planner
