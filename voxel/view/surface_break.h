// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace octotomy::voxel {

/// The largest difference of depth between points of the image `distance_mm` apart that still counts as one
/// surface instead of a break between two. A surface at 76 degrees to the image plane reaches it; steeper
/// ones are dark under a light at the observer. Gordon and Reynolds 1985 leave the value to the user; in the
/// thesis's terms (5.2.2.1) it is B = 4.
constexpr double break_mm(double distance_mm) {
  return 4.0 * distance_mm;
}

}  // namespace octotomy::voxel
