// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/expression.h"

namespace octotomy::voxel {

/// Volume, in cubic millimetres, of the points of the scan at which the trilinear interpolant of the samples
/// lies in the window. Of a boundary voxel only the part inside the surface is counted. A point belongs to
/// the scan if its nearest sample does. Beyond the scan's outermost samples the interpolant has their values,
/// so an object that reaches the scan's border extends half a sample farther. In cells that the surface
/// crosses, the interpolant is integrated exactly along the third axis over 4 x 4 lines; other cells are
/// counted fully or not. On smooth surfaces the error is of second order in the voxel's edge. Parallel; same
/// bits on any thread count.
double partial_volume_mm3(const Window& window);

}  // namespace octotomy::voxel
