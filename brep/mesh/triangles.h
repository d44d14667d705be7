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

/// Triangles with what lies beyond each side. A side is numbered as the corner that it leaves: 3 f + k is
/// side k of triangle f, from that corner to the next.
struct Linked {
  /// No such side: this one is on the boundary.
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  Triangles triangles;
  std::vector<std::uint32_t> opposite;  ///< by side, the other triangle's side of the same edge

  std::uint32_t from(std::uint32_t side) const { return triangles.faces[side / 3][side % 3]; }
  std::uint32_t to(std::uint32_t side) const { return triangles.faces[side / 3][(side + 1) % 3]; }
  /// Whether the side is the first of an edge that two triangles share: each such edge has one.
  bool is_inner_edge(std::uint32_t side) const { return opposite[side] != none && side < opposite[side]; }
  bool is_closed() const;
};

/// The triangles of mesh_of() without the mesh: numbered alike, copies of points included. Throws as that.
/// Cost: linear, parallel in parts, about 50 bytes a triangle.
Linked linked(Triangles triangles);

/// The same with what lies beyond each side. Precondition: nothing is marked as deleted.
Linked linked_of(const Mesh& mesh);

/// The mesh of linked triangles, numbered alike.
Mesh mesh_of(const Linked& linked);

/// Throws where mesh_of() would, at a third of its cost.
void check_joins(const Triangles& triangles);

/// The faces and vertices of a mesh in its own order. Precondition: nothing is marked as deleted.
Triangles triangles_of(const Mesh& mesh);

}  // namespace octotomy::brep
