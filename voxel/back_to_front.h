// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/camera.h"
#include "voxel/column_map.h"
#include "voxel/visits.h"

namespace octotomy::voxel {

/// Draws the objects back to front along an axis (thesis 4.4.3.1, A.2): every node is visited once, Full ones
/// are painted over what is behind them. The same map as node_trace().
/// Precondition: all objects are of one universe, for which axis_view() gave the axes. Visits are added to
/// `visits` where it is given. Cost: every node, and every column as often as it is painted.
ColumnMap back_to_front(const std::vector<Drawn>& objects, const AxisView& axes, Visits* visits = nullptr);

/// The same for any orthographic view: a Full node is painted as its convex polygon, the intersection of half
/// planes (equation 4.11), each pixel with the depth at which its ray enters the node. Depths are voxels'
/// faces. Precondition: all objects are of one universe, that of the plane.
DepthImage back_to_front(const std::vector<Drawn>& objects, const ImagePlane& plane,
                         Visits* visits = nullptr);

}  // namespace octotomy::voxel
