// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// Triangles as in files, with arbitrary connection.
struct Triangles {
  std::vector<glm::dvec3> points_mm;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// The mesh of these triangles: face i is triangle i, vertex i is point i, whether or not a triangle uses it.
/// Where fans of triangles touch only at a point, the first fan keeps the point and each further fan gets a
/// copy, after the last point; the surface does not change, and every vertex is manifold. Throws Error
/// (Input), which names the first triangle that refers to a missing point, repeats a point, is not finite, or
/// cannot be joined to the others without an edge of more than two triangles or of two with the same
/// direction; Error (Resource) if there are too many triangles for 32 bits. Cost: n log n, about 100 bytes
/// per triangle besides the mesh.
Mesh mesh_of(const Triangles& triangles);

/// Triangles with their neighbours. A side has the number of the corner at which it starts: 3 f + k is side k
/// of triangle f, from corner k to the next.
struct Linked {
  /// There is no opposite side: the side is on the boundary.
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  Triangles triangles;
  std::vector<std::uint32_t> opposite;  ///< for each side, the neighbour's side of the same edge

  std::uint32_t from(std::uint32_t side) const { return triangles.faces[side / 3][side % 3]; }
  std::uint32_t to(std::uint32_t side) const { return triangles.faces[side / 3][(side + 1) % 3]; }
  /// Whether the side is the first of an edge that two triangles share: each such edge has one.
  bool is_inner_edge(std::uint32_t side) const { return opposite[side] != none && side < opposite[side]; }
  bool is_closed() const;
};

/// The triangles of mesh_of() without the mesh: same numbers, copies of points included. Throws as mesh_of()
/// does. Cost: linear, parallel in parts, about 50 bytes per triangle.
Linked linked(Triangles triangles);

/// The triangles of a mesh with their neighbours. Precondition: nothing is marked as deleted.
Linked linked_of(const Mesh& mesh);

/// The mesh of linked triangles, with the same numbers.
Mesh mesh_of(const Linked& linked);

/// Throws if mesh_of() would throw, at a third of the cost of mesh_of().
void check_joins(const Triangles& triangles);

/// The faces and vertices of a mesh in its own order. Precondition: nothing is marked as deleted.
Triangles triangles_of(const Mesh& mesh);

}  // namespace octotomy::brep
