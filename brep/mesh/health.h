// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// What keeps triangles from being a solid, in the order of the checks.
enum class Defect {
  NoTriangles,
  Open,               ///< an edge with one triangle
  NonmanifoldEdge,    ///< one with more than two
  NonmanifoldVertex,  ///< a point where more than one fan of triangles meets
  Misoriented,        ///< neighbours that wind against each other
  Degenerate,         ///< a triangle without area
  Duplicate,          ///< triangles with the same points
  MisplacedShell,     ///< a shell that faces the wrong way for those around it
  InsideOut,          ///< every shell is turned over, or the whole volume is not positive
  SelfIntersection,
};

/// What a mesh is fit for, checked in this order; an empty `findings` means a solid (or, where the
/// intersection test was not asked for, that nothing else speaks against one). An edge is a pair of points
/// that some triangle joins. Points that no triangle uses are counted but speak against nothing.
struct Health {
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t unused_vertices = 0;       ///< of them, in no triangle
  std::size_t components = 0;            ///< triangles connected at corners
  std::size_t shells = 0;                ///< triangles connected across edges
  long euler = 0;                        ///< V - E + F of the vertices in use
  std::size_t boundary_edges = 0;        ///< with one triangle
  std::size_t coincident_points = 0;     ///< in use, where an earlier one in use stands
  std::size_t unwelded_edges = 0;        ///< boundary edges that close when coincident points become one
  std::size_t nonmanifold_edges = 0;     ///< with more than two
  std::size_t nonmanifold_vertices = 0;  ///< where more than one fan of triangles meets
  std::size_t misoriented_edges = 0;     ///< with two triangles that run along it the same way
  std::size_t degenerate_faces = 0;      ///< area zero in exact arithmetic
  std::size_t duplicate_faces = 0;       ///< pairs with the same three points
  std::size_t misplaced_shells = 0;      ///< turned outward in a solid or inward outside of one
  bool intersections_tested = false;
  /// Pairs that meet elsewhere than in a shared corner or side; duplicates are such.
  std::size_t self_intersections = 0;
  std::vector<std::pair<int, int>> crossing;  ///< first pairs of triangles that intersect, at most 100
  bool closed = false;                        ///< triangles, and every edge has at least two
  bool manifold = false;
  /// Neighbours agree; where closed, also every shell's outside is where the shells around it say, and the
  /// total volume is positive.
  bool oriented = false;
  std::vector<std::string> findings;  ///< each names the first triangle that it is about, by number and place
  std::optional<Defect> first_defect;  ///< that of the first finding

  bool solid() const { return !first_defect; }
};

struct HealthOptions {
  bool self_intersections = true;  ///< the dearest test by far
};

/// Health of triangles as they are connected by their point numbers. Degenerate triangles are left out of the
/// intersection test, which is exact and parallel, with the same answer on any thread count. Throws Error
/// (Input) if a triangle refers to no point or to one that is not finite. Cost: n log n; the intersection
/// test dominates (about 1 s for 300k triangles).
Health health(const Triangles& triangles, const HealthOptions& options = {});
Health health(const Mesh& mesh, const HealthOptions& options = {});

}  // namespace octotomy::brep
