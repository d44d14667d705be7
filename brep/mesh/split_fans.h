// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// An edge whose triangles were joined otherwise than by all of them meeting in it.
struct SplitEdge {
  std::uint32_t from = 0, to = 0;  ///< points of what came in, the lower number first
  std::size_t triangles = 0;       ///< that share the edge
  std::size_t pairs = 0;           ///< of them joined two and two; the others end at the edge
  glm::dvec3 at_mm{0.0};           ///< its middle
};

struct SplitFans {
  Triangles surface;                    ///< what mesh_of() takes; nothing has moved
  std::vector<SplitEdge> edges;         ///< every edge that was split, by its points
  std::vector<std::uint32_t> left_out;  ///< triangles that repeat a point, ascending
  /// For each point of the surface the one it was; copies stand behind the last, an edge's middle counts as a
  /// copy of its lower point.
  std::vector<std::uint32_t> origin;
  /// For each triangle of the surface the one it was.
  std::vector<std::uint32_t> face_origin;
};

/// Triangles of any connection as mesh_of() takes them. At an edge of more than two triangles, or of two that
/// run along it the same way, neighbours about the edge that have the solid between them are joined and
/// others end there; each fan of triangles about a point gets a copy of the point, and pairs that share both
/// ends of the edge all the same are cut at its middle. Triangles that repeat a point are left out. A closed
/// surface whose triangles balance at every edge stays closed. Throws Error (Input) for a triangle that
/// refers to no point or to one that is not finite. Cost: n log n. Source: Gueziec, Taubin, Lazarus, Horn,
/// "Cutting and stitching: converting sets of polygons to manifold surfaces", TVCG 7(2), 2001; pairs about an
/// edge by angle, as solids that touch in the edge have them.
SplitFans split_fans(const Triangles& triangles);

/// "edge of 3 triangles at (1, 2, 3) mm: 1 pair joined, 1 triangle ends there".
std::string to_string(const SplitEdge& edge);

/// The surface of any triangles, joined where it can be, with a finding for each thing done to join it.
struct JoinedSurface {
  Triangles surface;
  std::vector<std::string> findings;  ///< empty where mesh_of() takes the triangles as they are
};

/// Points that coincide become one where that closes open edges; then split_fans() where mesh_of() needs it.
/// At most ten edges are told one by one. Throws as split_fans().
JoinedSurface joined_surface(Triangles triangles);

}  // namespace octotomy::brep
