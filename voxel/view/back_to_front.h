// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/column_map.h"
#include "voxel/view/visits.h"

namespace octotomy::voxel {

/// Draws the objects back to front along an axis (thesis 4.4.3.1, A.2): visits every node once and paints
/// Full nodes over those behind. Returns the same map as node_trace(). Adds visits to `visits` if given.
/// Precondition: all objects are of one universe, and `axes` is a result of its axis_view(). Cost: one visit
/// per node and one write each time a column is painted.
ColumnMap back_to_front(const std::vector<DrawnObject>& objects, const AxisView& axes,
                        Visits* visits = nullptr);

/// Draws back to front in any orthographic view: paints a Full node as its convex polygon, the intersection
/// of half planes (equation 4.11). A pixel's depth is that at which its ray enters the node, so depths are
/// those of voxels' faces. Precondition: all objects are of the plane's universe.
DepthImage back_to_front(const std::vector<DrawnObject>& objects, const ImagePlane& plane,
                         Visits* visits = nullptr);

}  // namespace octotomy::voxel
