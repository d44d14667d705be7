// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Integrals over a closed mesh and its interior, by the divergence theorem. They are summed relative to the
/// mesh's centre in a fixed order, so that results do not depend on threads, nor on the position beyond the
/// rounding of points.
struct Measures {
  double volume_mm3 = 0.0;  ///< negative if the triangles wind inward
  double area_mm2 = 0.0;
  std::optional<glm::dvec3> centroid_mm;  ///< centroid of the interior; none if the volume is zero
  /// Inertia tensor about the centroid at a density of 1 per cubic millimetre, along the LPS axes; none if
  /// the volume is zero.
  std::optional<glm::dmat3> inertia_mm5;
  glm::dvec3 low_mm{0.0}, high_mm{0.0};  ///< bounding box of the faces; both zero if there are none
  /// Half the sum over edges of length times unsigned angle between the faces' normals: the total absolute
  /// mean curvature, which bounds the volume that a chordal approximation loses. 4 pi r for a sphere in the
  /// limit, 3 pi a for a cube of edge a. Edges at a triangle without area are skipped.
  double absolute_mean_curvature_mm = 0.0;
};

/// Volume and centroid are meaningful only for closed meshes; check with health() if in doubt. Area, box and
/// curvature (of inner edges) are also correct for open ones. Precondition: nothing is marked as deleted. The
/// same bits on any number of threads. Cost: linear, parallel, 24 bytes per face.
Measures measure(const Mesh& mesh);

/// Measures linked triangles. If the triangles are closed, the result equals measure(mesh_of(linked)) bit for
/// bit. Cost: linear, parallel, 30 bytes per triangle.
Measures measure(const Linked& linked);

/// V - E + F of a closed surface, counting points in use. Precondition: each edge has two triangles. Cost:
/// linear.
long euler_number(const Triangles& surface);

/// The measures of triangles that do not depend on their connection, as in Measures.
struct Size {
  double volume_mm3 = 0.0;
  double area_mm2 = 0.0;
  glm::dvec3 low_mm{0.0}, high_mm{0.0};
};

/// Returns the same bits as measure() at a fraction of the cost, because no edges are visited.
Size size_of(const Triangles& triangles);
Size size_of(const Mesh& mesh);
double volume_mm3(const Mesh& mesh);

}  // namespace octotomy::brep
