// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// An edge whose triangles were not all joined to one another.
struct SplitEdge {
  std::uint32_t from = 0, to = 0;  ///< points of the input, the lower number first
  std::size_t triangles = 0;       ///< number of triangles that share the edge
  std::size_t pairs = 0;           ///< number of pairs that were joined; the other triangles end at the edge
  glm::dvec3 at_mm{0.0};           ///< middle of the edge
};

struct SplitFans {
  Triangles surface;                    ///< a surface that mesh_of() accepts; no point has moved
  std::vector<SplitEdge> edges;         ///< every edge that was split, in order of its points
  std::vector<std::uint32_t> left_out;  ///< triangles that repeat a point, ascending
  /// For each point of the surface, its point in the input. Copies follow the last point; an edge's middle
  /// counts as a copy of its lower point.
  std::vector<std::uint32_t> origin;
  /// For each triangle of the surface, its triangle in the input.
  std::vector<std::uint32_t> face_origin;
};

/// Converts arbitrary triangles to a surface that mesh_of() accepts. At an edge of more than two triangles,
/// or of two with the same direction, neighbours around the edge with the solid between them are joined; the
/// others end there. Each further fan of triangles around a point gets a copy of the point, and pairs that
/// still share both ends of an edge are divided at the edge's middle. Triangles that repeat a point are left
/// out. A closed surface with equally many triangles in both directions at every edge stays closed. Throws
/// Error (Input) for a triangle that refers to a missing point or to one that is not finite. Cost: n log n.
/// Source: Gueziec, Taubin, Lazarus, Horn, "Cutting and stitching: converting sets of polygons to manifold
/// surfaces", TVCG 7(2), 2001; pairs around an edge are chosen by angle, as for solids that touch at the
/// edge.
SplitFans split_fans(const Triangles& triangles);

/// "edge of 3 triangles at (1, 2, 3) mm: 1 pair joined, 1 triangle ends there".
std::string to_string(const SplitEdge& edge);

/// The surface of arbitrary triangles, joined where possible, with a finding for each change.
struct JoinedSurface {
  Triangles surface;
  std::vector<std::string> findings;  ///< empty if mesh_of() accepts the triangles unchanged
};

/// Merges coincident points if that closes open edges, then applies split_fans() if mesh_of() needs it. Lists
/// at most ten edges individually. Throws as split_fans() does.
JoinedSurface joined_surface(Triangles triangles);

}  // namespace octotomy::brep
