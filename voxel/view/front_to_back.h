// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/column_map.h"
#include "voxel/view/visits.h"

namespace octotomy::voxel {

/// Draws the objects front to back along an axis (thesis 4.4.3.2, A.2): walks octree and quadtree together
/// and skips nodes that project onto covered quadtree nodes. Returns the same map as node_trace(). Adds
/// visits to `visits` if given. Precondition: all objects have one universe, and `axes` was returned by
/// axis_view() for it.
ColumnMap front_to_back(const std::vector<DrawnObject>& objects, const AxisView& axes,
                        Visits* visits = nullptr);

/// Draws front to back in any orthographic view: an octree node's projection lies in at most four quadtree
/// nodes of the same level (theorems 4.1 and 4.2), and the octree node is visited if one of these is not
/// covered yet. Returns the same depths as back_to_front(). Precondition: all objects have the plane's
/// universe.
DepthImage front_to_back(const std::vector<DrawnObject>& objects, const ImagePlane& plane,
                         Visits* visits = nullptr);

}  // namespace octotomy::voxel
