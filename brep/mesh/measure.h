// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Integrals over a closed mesh and its inside, by the divergence theorem, summed about the mesh's own centre
/// in a fixed order so that neither place nor threads change the answer beyond rounding of the points.
struct Measures {
  double volume_mm3 = 0.0;  ///< negative where the triangles wind the wrong way round
  double area_mm2 = 0.0;
  std::optional<glm::dvec3> centroid_mm;  ///< of the inside; none where there is no volume
  /// Inertia tensor about the centroid at a density of 1 per cubic millimetre, along the LPS axes; none where
  /// there is no volume.
  std::optional<glm::dmat3> inertia_mm5;
  glm::dvec3 low_mm{0.0}, high_mm{0.0};  ///< bounding box of the faces; both zero where there are none
  /// Half the sum over edges of length times unsigned angle between the faces' normals: the total absolute
  /// mean curvature, which bounds how much a chordal surface loses. 4 pi r for a sphere in the limit, 3 pi a
  /// for a cube of edge a. Edges at a triangle without area count nothing.
  double absolute_mean_curvature_mm = 0.0;
};

/// Volume and centroid mean something for closed meshes only: ask health() where that is in doubt; area, box
/// and curvature (inner edges) are right for open ones too. Precondition: nothing is marked as deleted. The
/// same bits on any number of threads. Cost: linear, parallel, 24 bytes a face.
Measures measure(const Mesh& mesh);

/// The same of triangles with their neighbours; for closed ones the same bits as of mesh_of() them. Cost:
/// linear, parallel, 30 bytes a triangle.
Measures measure(const Linked& linked);

/// V - E + F of the points in use of a closed surface, of whose edges each has two triangles. Cost: linear.
long euler_number(const Triangles& surface);

/// What can be said of triangles without their connection, as in Measures.
struct Size {
  double volume_mm3 = 0.0;
  double area_mm2 = 0.0;
  glm::dvec3 low_mm{0.0}, high_mm{0.0};
};

/// The same bits as measure()'s at a fraction of the cost, as no edges are visited.
Size size_of(const Triangles& triangles);
Size size_of(const Mesh& mesh);
double volume_mm3(const Mesh& mesh);

}  // namespace octotomy::brep
