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

/// Defects that keep triangles from being a solid, in the order of the checks.
enum class Defect {
  NoTriangles,
  Open,               ///< an edge with one triangle
  NonmanifoldEdge,    ///< an edge with more than two triangles
  NonmanifoldVertex,  ///< a point where more than one fan of triangles meets
  Misoriented,        ///< neighbours with opposite winding
  Degenerate,         ///< a triangle without area
  Duplicate,          ///< triangles with the same points
  MisplacedShell,     ///< a shell whose orientation does not fit the shells around it
  InsideOut,          ///< every shell is reversed, or the total volume is not positive
  SelfIntersection,
};

/// The checks of a mesh, in this order. Empty `findings` mean a solid or, without the intersection test, that
/// no other check failed. An edge is a pair of points that a triangle connects. Points that no triangle uses
/// are counted but are no defect.
struct Health {
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t unused_vertices = 0;       ///< vertices in no triangle
  std::size_t components = 0;            ///< triangles connected at corners
  std::size_t shells = 0;                ///< triangles connected across edges
  long euler = 0;                        ///< V - E + F, where V counts only vertices in use
  std::size_t boundary_edges = 0;        ///< edges with one triangle
  std::size_t coincident_points = 0;     ///< points in use that coincide with an earlier one in use
  std::size_t unwelded_edges = 0;        ///< boundary edges that would close if coincident points were merged
  std::size_t nonmanifold_edges = 0;     ///< edges with more than two triangles
  std::size_t nonmanifold_vertices = 0;  ///< vertices where more than one fan of triangles meets
  std::size_t misoriented_edges = 0;     ///< edges of two triangles with the same direction
  std::size_t degenerate_faces = 0;      ///< triangles whose area is zero in exact arithmetic
  std::size_t duplicate_faces = 0;       ///< pairs of triangles with the same three points
  std::size_t misplaced_shells = 0;      ///< outward shells inside a solid, or inward shells outside of one
  bool intersections_tested = false;
  /// Pairs of triangles that meet outside a shared corner or side, including duplicates. Corners with equal
  /// coordinates are shared: sheets that touch there do not intersect.
  std::size_t self_intersections = 0;
  std::vector<std::pair<int, int>> crossing;  ///< first pairs of triangles that intersect, at most 100
  bool closed = false;                        ///< there are triangles, and every edge has at least two
  bool manifold = false;
  /// Neighbours have consistent winding. If the mesh is closed, every shell's orientation also fits the
  /// shells around it, and the total volume is positive.
  bool oriented = false;
  std::vector<std::string> findings;   ///< each names its first triangle by number and position
  std::optional<Defect> first_defect;  ///< defect of the first finding

  bool solid() const { return !first_defect; }
};

struct HealthOptions {
  bool self_intersections = true;  ///< whether to run the intersection test, by far the most expensive one
};

/// Health of triangles as they are connected by their point numbers. Degenerate triangles are excluded from
/// the intersection test, which is exact and parallel, with the same result on any thread count. Throws Error
/// (Input) if a triangle refers to a missing point or to one that is not finite. Cost: n log n; the
/// intersection test dominates (about 1 s for 300k triangles).
Health health(const Triangles& triangles, const HealthOptions& options = {});
Health health(const Mesh& mesh, const HealthOptions& options = {});

}  // namespace octotomy::brep
