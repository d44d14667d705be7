// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace octotomy::voxel {

/// The largest difference of depth, in millimetres, between points of the image `distance_mm` apart that is
/// taken for one surface and not for a break between two: that of a surface which stands at 76 degrees to the
/// image plane, beyond which head light leaves no shade to see. Gordon and Reynolds 1985 leave this to the
/// user; in the thesis's terms (5.2.2.1) it is B = 4.
constexpr double break_mm(double distance_mm) {
  return 4.0 * distance_mm;
}

}  // namespace octotomy::voxel
