// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/view/column_map.h"

namespace octotomy::voxel {

/// Traces the objects along the view's look (thesis 4.5). The nearest voxel of any object is visible; if
/// several objects contain it, it belongs to the first of these objects. With DrawnObject::grey the depth is
/// the crossing of the threshold between the centres of the last voxel outside and the first inside (thesis
/// 5.2.2.2); if the samples at these voxels do not cross the threshold, the object was cut there, and the
/// depth is that of the voxel's face. Precondition: all objects have one universe, and `axes` was returned by
/// axis_view() for it. Unbuilt objects are evaluated only where they are visible (thesis chapter 7). Their
/// voxels equal those of the built object, but no octree is made. Parallel over tiles of 64 x 64 columns;
/// same bits on any thread count. Cost: proportional to the visible boundary.
ColumnMap node_trace(const std::vector<DrawnObject>& objects, const AxisView& axes);

}  // namespace octotomy::voxel
