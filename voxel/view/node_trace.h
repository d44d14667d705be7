// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/view/column_map.h"

namespace octotomy::voxel {

/// Traces the objects along the view's look (thesis 4.5). The nearest voxel of any object wins; if several
/// objects contain it, the first of these objects. With DrawnObject::grey the depth is the crossing of the
/// threshold between the centres of the last voxel outside and the first inside (thesis 5.2.2.2); if these
/// samples do not cross the threshold, the object was cut there, and the depth is that of the voxel's face.
/// Precondition: all objects are of one universe, and `axes` is a result of its axis_view(). Unbuilt objects
/// are evaluated only where they are visible. Their voxels are those of the built object, but no octree is
/// made (thesis chapter 7). Parallel over tiles of 64 x 64 columns; same bits on any thread count. Cost:
/// proportional to the visible boundary.
ColumnMap node_trace(const std::vector<DrawnObject>& objects, const AxisView& axes);

}  // namespace octotomy::voxel
