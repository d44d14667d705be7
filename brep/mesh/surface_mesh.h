// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <CGAL/Surface_mesh.h>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The triangles as CGAL's mesh, for sources that include CGAL: vertex i is point i and, if all can be
/// joined, face i is triangle i. Cost: linear.
template <typename Point>
CGAL::Surface_mesh<Point> surface_mesh_of(const Triangles& triangles) {
  using Surface = CGAL::Surface_mesh<Point>;
  using Vertex = typename Surface::Vertex_index;
  Surface surface;
  for (const glm::dvec3& p : triangles.points_mm) surface.add_vertex(Point(p.x, p.y, p.z));
  for (const auto& face : triangles.faces)
    surface.add_face(Vertex(face[0]), Vertex(face[1]), Vertex(face[2]));
  return surface;
}

}  // namespace octotomy::brep
