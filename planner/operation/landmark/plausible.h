// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/landmark/skull_profile.h"

namespace octotomy::planner {

/// Takes out places that cannot be what they are called, with the reason: heights out of order, lengths that
/// no face has as shares of the height of its nose, and sides that do not match. Sides that match badly are
/// in doubt by what they differ. Places are in the head's frame, pitched as the Frankfurt plane to
/// some 6 degrees.
void keep_plausible(FoundPlaces& found);

}  // namespace octotomy::planner
