// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/mesh.h"
#include "voxel/space/scene.h"
#include "voxel/space/view.h"

// Contours of an object or of a window in an arbitrary plane, as closed polygons in a view's millimetres.
namespace octotomy::planner {

/// The plane of points p with dot(p, view.look) = position_mm.
struct ViewPlane {
  voxel::View view;
  double position_mm = 0.0;

  glm::dvec3 lps_mm(const glm::dvec2& p_mm) const {
    return p_mm.x * view.right + p_mm.y * view.up + position_mm * view.look;
  }
};

using PlaneContours = std::vector<std::vector<glm::dvec2>>;

/// The contours of the window low..high of a scan in a plane. The scan is interpolated trilinearly on a grid
/// of its finest spacing. Objects end at the scan's border. Either bound may be infinite. Empty if no point
/// lies in the window. Throws voxel::Error (Resource) if the grid has more than 2^26 points. Cost: linear in
/// the points; parallel.
PlaneContours contours_in_plane(const voxel::Scene& scene, double low, double high, const ViewPlane& plane);

/// The closed contours in which a plane cuts a surface, separated where they touch (brep::part_touching()).
/// Contours that end at the border of an open surface are left out, and their number is added to `open`.
/// Cost: linear in the triangles.
PlaneContours contours_in_plane(const brep::Mesh& surface, const ViewPlane& plane,
                                std::size_t* open = nullptr);

/// Returns the outline of the region that contains a point, and the contours of that region's holes. Empty if
/// the point lies outside of all regions or in a hole. Precondition: the contours do not cross.
PlaneContours region_around(const PlaneContours& contours, const glm::dvec2& p_mm);

}  // namespace octotomy::planner
