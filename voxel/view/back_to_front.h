// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/column_map.h"
#include "voxel/view/visits.h"

namespace octotomy::voxel {

/// Draws the objects back to front along an axis (thesis 4.4.3.1, A.2): visits every node once and paints
/// Full nodes over those behind. Returns the same map as node_trace(). Adds visits to `visits` if given.
/// Precondition: all objects have one universe, and `axes` was returned by axis_view() for it. Cost: one
/// visit per node, and one write for each column of each painted node.
ColumnMap back_to_front(const std::vector<DrawnObject>& objects, const AxisView& axes,
                        Visits* visits = nullptr);

/// Draws back to front in any orthographic view: paints a Full node as its convex polygon, the intersection
/// of half planes (equation 4.11). A pixel's depth is the depth at which its ray enters the node, so depths
/// are those of voxels' faces. Precondition: all objects have the plane's universe.
DepthImage back_to_front(const std::vector<DrawnObject>& objects, const ImagePlane& plane,
                         Visits* visits = nullptr);

}  // namespace octotomy::voxel
