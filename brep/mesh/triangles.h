// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// Triangles as files and generators have them: nothing is promised of their connection.
struct Triangles {
  std::vector<glm::dvec3> points_mm;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// The mesh of these triangles: face i is triangle i, vertex i is point i, whether a triangle uses it or not.
/// Where fans of triangles only touch at a point, the first keeps it and each further fan gets a copy behind
/// the last point, so that the surface stays where it is and every vertex is manifold. Throws Error (Input)
/// naming the first triangle that refers to no point, repeats a point, is not finite, or cannot be joined to
/// the others without an edge of more than two triangles or of two that run along it the same way; Error
/// (Resource) if 32 bits do not number the triangles. Cost: n log n, about 100 bytes a triangle beside the
/// mesh.
Mesh mesh_of(const Triangles& triangles);

/// Triangles with what lies beyond each side.
struct Linked {
  /// No such corner: the side is on the boundary.
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  Triangles triangles;
  /// For side k of triangle f at 3 f + k: the corner, numbered alike, that the other triangle's side leaves.
  std::vector<std::uint32_t> opposite;
};

/// The triangles of mesh_of() without the mesh: numbered alike, copies of points included. Throws as that.
/// Cost: linear, about 90 bytes a triangle.
Linked linked(Triangles triangles);

/// Throws where mesh_of() would, at a third of its cost.
void check_joins(const Triangles& triangles);

/// The faces and vertices of a mesh in its own order. Precondition: nothing is marked as deleted.
Triangles triangles_of(const Mesh& mesh);

}  // namespace octotomy::brep
