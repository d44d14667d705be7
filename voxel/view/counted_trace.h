// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/column_map.h"
#include "voxel/view/visits.h"

// Node tracing and ray casting in the thesis's terms, one logical node at a time, so that their visits can be
// counted. node_trace() and RayCast draw the same pictures much faster.

namespace octotomy::voxel {

/// Node tracing as in the thesis (4.5.2): quadtree rays step from node to node, split into four at Partial
/// nodes, and find neighbours by walking down from the pivot in their ancestor array. Returns the same map as
/// node_trace(). The neighbour gets a direct visit, the nodes between pivot and neighbour get indirect
/// visits; the quadtree gets recursion level - pivot level - 1 indirect visits (A.3.1.2). Adds visits to
/// `visits` if given. Precondition: that of node_trace().
ColumnMap quadtree_trace(const std::vector<DrawnObject>& objects, const AxisView& axes,
                         Visits* visits = nullptr);

/// Node tracing in any orthographic view (thesis 4.5 for its principle, 4.4.3.2 for nodes' polygons): the
/// picture is traced as one square beam, which is split into four until a Full node covers the beam or no
/// node is in the beam; a beam of one pixel is the ray through the pixel's centre. A beam opens the Partial
/// nodes that are larger than itself. Returns the same depths as front_to_back(). A visit is the opening of a
/// node by a beam; adds the visits to `visits` if given. Precondition: all objects are built and have the
/// plane's universe. Parallel over tiles of 64 x 64 pixels unless visits are counted.
DepthImage quadtree_trace(const std::vector<DrawnObject>& objects, const ImagePlane& plane,
                          Visits* visits = nullptr);

/// Adds to `visits` the visits of one ray per pixel, through the pixel's centre, until the ray meets a Full
/// node. They are counted like those of a ray on the deepest level of quadtree_trace().
void count_rays(const std::vector<DrawnObject>& objects, const ImagePlane& plane, Visits& visits);

}  // namespace octotomy::voxel
