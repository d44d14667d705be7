// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct DecimateOptions {
  /// Largest distance of a remaining vertex from the planes of the triangles that it replaces. A third of the
  /// spacing of a scan's samples removes two of three triangles of an isosurface.
  double max_error_mm = 0.1;
  std::optional<std::size_t> faces;      ///< stops at this number of faces, if the other bounds do not stop
                                         ///< it earlier
  double max_normal_deviation_deg = 45;  ///< of a triangle at one collapse, 0..90
  double max_aspect = 10;  ///< largest allowed ratio of longest side to height for new triangles
  int max_rounds = 8;      ///< see below; at least 1
};

/// A coarser mesh of the same topology whose vertices are vertices of the given one. Edges are collapsed in
/// order of the resulting error. A collapse does not check distant triangles, so a round that makes the mesh
/// intersect itself is repeated with the vertices around the intersections locked. Precondition: closed,
/// manifold, without self-intersection; the result is that too. Throws std::invalid_argument if an option is
/// out of its range or the mesh is open, Error (Geometry) if `max_rounds` rounds do not remove
/// self-intersections. Deterministic. Cost: n log n per round, usually two rounds. Source: Garland and
/// Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997, by OpenMesh's Decimater,
/// halfedge collapses.
Mesh decimate(const Mesh& mesh, const DecimateOptions& options = {});

}  // namespace octotomy::brep
