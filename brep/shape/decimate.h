// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct DecimateOptions {
  /// Largest distance of a vertex that stays from the planes of the triangles it stands for. A third of the
  /// spacing of a scan's samples takes two triangles of three from an isosurface.
  double max_error_mm = 0.1;
  std::optional<std::size_t> faces;      ///< ends there where the other bounds have not ended it before
  double max_normal_deviation_deg = 45;  ///< of a triangle at one collapse, 0..90
  double max_aspect = 10;  ///< longest side by height, above which a triangle may not come to be
  int max_rounds = 8;      ///< see below; at least 1
};

/// A coarser mesh of the same topology whose vertices are vertices of the given one: edges are collapsed in
/// the order of the error they make. Collapses know nothing of triangles further along the surface, so a
/// round that makes the mesh intersect itself is done again with the vertices about those places locked.
/// Precondition: closed, manifold, without self-intersection; the result is that too. Throws
/// std::invalid_argument where an option is out of its range or the mesh is open, Error (Geometry) if
/// `max_rounds` do not get rid of self-intersections. Deterministic. Cost: n log n a round, two rounds as a
/// rule.
/// Source: Garland and Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997, by
/// OpenMesh's Decimater, halfedge collapses.
Mesh decimate(const Mesh& mesh, const DecimateOptions& options = {});

}  // namespace octotomy::brep
