// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/mesh.h"
#include "voxel/space/scene.h"
#include "voxel/space/view.h"

// Contours of an object or of a window in any plane: closed polygons in a view's millimetres.
namespace octotomy::planner {

/// The plane of points p with p . view.look = position_mm.
struct ViewPlane {
  voxel::View view;
  double position_mm = 0.0;

  glm::dvec3 lps_mm(const glm::dvec2& p_mm) const {
    return p_mm.x * view.right + p_mm.y * view.up + position_mm * view.look;
  }
};

using PlaneContours = std::vector<std::vector<glm::dvec2>>;

/// The contours of the window low..high of a scan, which is interpolated trilinearly at points as far apart
/// as its finest spacing. Objects end at the scan's border. Either bound may be infinite. Empty where the
/// plane misses the window. Throws voxel::Error (Resource) if the plane has more than 2^26 such points. Cost:
/// linear in them; parallel.
PlaneContours contours_in_plane(const voxel::Scene& scene, double low, double high, const ViewPlane& plane);

/// The closed contours at which a plane cuts a surface, parted where they touch (brep::part_touching()). Contours that
/// end at the border of an open surface are left out; their number is added to `open`. Cost: linear in the triangles.
PlaneContours contours_in_plane(const brep::Mesh& surface, const ViewPlane& plane,
                                std::size_t* open = nullptr);

/// Of contours that do not cross, the contour around the region that contains a point, and the contours of
/// the region's holes. Empty if the point lies outside all regions or in a hole.
PlaneContours region_around(const PlaneContours& contours, const glm::dvec2& p_mm);

}  // namespace octotomy::planner
