// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/column_map.h"

namespace octotomy::voxel {

/// Traces the objects along the view's look (thesis 4.5), the nearest voxel of any object winning and the
/// first object listed where several hold it. With Drawn::grey the depth lies where the threshold is crossed
/// between the centre of the last voxel outside and the first inside (thesis 5.2.2.2); where the samples do
/// not cross it, the object was cut there and the voxel's face stays.
/// Precondition: all objects are of one universe, for which axis_view() gave the axes.
/// Parallel over tiles of 64 x 64 columns; same bits on any thread count. Cost: the visible boundary.
ColumnMap node_trace(const std::vector<Drawn>& objects, const AxisView& axes);

}  // namespace octotomy::voxel
