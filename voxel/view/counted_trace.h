// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/column_map.h"
#include "voxel/view/visits.h"

// Node tracing and ray casting in the thesis's terms, one logical node at a time, to count their visits.
// node_trace() and RayCast draw the same pictures much faster.

namespace octotomy::voxel {

/// Node tracing as in the thesis (4.5.2): quadtree rays step from node to node, split into four at Partial
/// nodes, and find neighbours by walking down from the pivot in their ancestor array. The same map as
/// node_trace(). The neighbour gets a direct visit, the nodes between pivot and neighbour indirect ones; the
/// quadtree gets recursion level - pivot level - 1 indirect visits (A.3.1.2). Adds visits to `visits` if
/// given. Precondition: as node_trace().
ColumnMap quadtree_trace(const std::vector<DrawnObject>& objects, const AxisView& axes,
                         Visits* visits = nullptr);

/// Adds the visits of one ray per pixel, through the pixel's centre, until it meets a Full node. They are
/// counted like those of a ray of the deepest level in quadtree_trace().
void count_rays(const std::vector<DrawnObject>& objects, const ImagePlane& plane, Visits& visits);

}  // namespace octotomy::voxel
