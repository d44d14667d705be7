// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/camera.h"
#include "voxel/column_map.h"
#include "voxel/visits.h"

// Node tracing and ray casting in the thesis's terms, one logical node at a time, for counting what they
// visit. node_trace() and RayCast draw the same much faster.

namespace octotomy::voxel {

/// Node tracing as the thesis has it (4.5.2): quadtree rays step from node to node, split into four at
/// Partial nodes, and find neighbours by walking up from the pivot along their ancestor array. The same map
/// as node_trace(). A neighbour is a direct visit, the nodes passed between the pivot and it are indirect
/// ones; the quadtree gets recursion level - pivot level - 1 indirect visits (A.3.1.2). Precondition: as
/// node_trace(). Visits are added to `visits` where it is given.
ColumnMap quadtree_trace(const std::vector<Drawn>& objects, const AxisView& axes, Visits* visits = nullptr);

/// Adds the visits of one ray a pixel, each through the pixel's centre, until it meets a Full node; counted
/// as quadtree_trace() counts those of a ray of the deepest level.
void count_rays(const std::vector<Drawn>& objects, const ImagePlane& plane, Visits& visits);

}  // namespace octotomy::voxel
