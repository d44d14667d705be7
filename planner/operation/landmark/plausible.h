// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/landmark/skull_profile.h"

namespace octotomy::planner {

/// Removes landmarks in implausible positions and states the reason: heights out of order, lengths that no
/// face has relative to the height of its nose, or left and right sides that differ too much. A smaller
/// difference of the sides is added to the doubt of both. Positions are in the head's frame, whose pitch
/// differs from the Frankfurt plane's by at most about 6 degrees.
void keep_plausible(FoundPlaces& found);

}  // namespace octotomy::planner
