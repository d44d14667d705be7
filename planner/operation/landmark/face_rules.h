// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/landmark/skull_profile.h"

namespace octotomy::planner {

/// Landmarks of both sides, each with _left and _right: the piriform rims, the orbits' lowest rims, the
/// zygomatic buttresses, the zygomatic arches' outermost points and the mandible's angles. Adds to the
/// landmarks of the profile. `higher_mm` shifts the heights that the rules choose.
void find_face_places(const HeadMaps& maps, const NasalOpening& nose, double higher_mm, FoundPlaces& found);

/// The point of the mid-line at the nose's root.
void find_nose_root(const HeadMaps& maps, const NasalOpening& nose, FoundPlaces& found);

}  // namespace octotomy::planner
