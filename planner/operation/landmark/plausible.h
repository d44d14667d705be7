// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/landmark/skull_profile.h"

namespace octotomy::planner {

/// Removes landmarks in implausible positions, with the reason: heights out of order, lengths that no face
/// has in proportion to the height of its nose, and sides that do not match. Where sides match badly, their
/// difference is added to the doubt. Positions are in the head's frame, whose pitch differs from the
/// Frankfurt plane's by at most about 6 degrees.
void keep_plausible(FoundPlaces& found);

}  // namespace octotomy::planner
