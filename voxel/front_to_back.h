// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/camera.h"
#include "voxel/column_map.h"
#include "voxel/visits.h"

namespace octotomy::voxel {

/// Draws the objects front to back along an axis (thesis 4.4.3.2, A.2): octree and quadtree are walked
/// together, and what projects onto quadtree nodes that are already covered is left out. The same map as
/// node_trace(). Precondition: all objects are of one universe, for which axis_view() gave the axes. Visits
/// are added to `visits` where it is given.
ColumnMap front_to_back(const std::vector<Drawn>& objects, const AxisView& axes, Visits* visits = nullptr);

/// The same for any orthographic view: the projection of a node is covered by at most four quadtree nodes of
/// its level (theorems 4.1 and 4.2), and a node is visited where one of these is not covered yet. The same
/// depths as back_to_front(). Precondition: all objects are of one universe, that of the plane.
DepthImage front_to_back(const std::vector<Drawn>& objects, const ImagePlane& plane,
                         Visits* visits = nullptr);

}  // namespace octotomy::voxel
