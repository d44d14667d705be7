// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/expression.h"

namespace octotomy::voxel {

/// Volume of the points of the scan at which the trilinear interpolant of the samples lies in the window, in
/// cubic millimetres: boundary voxels count by the part of them that the surface cuts off. A point is the
/// scan's if the sample nearest to it is; beyond the scan's last samples the interpolant keeps their values,
/// so that an object that ends with the scan reaches half a sample further. In cells that the surface crosses the interpolant is integrated
/// exactly along the third axis, over 4 x 4 lines; the rest are counted. On smooth surface second order in
/// the voxel's edge, without the half voxel's scatter of a count. Parallel; same bits on any thread count.
double partial_volume_mm3(const Window& window);

}  // namespace octotomy::voxel
