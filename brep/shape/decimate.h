// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct DecimateOptions {
  /// Largest distance of either surface from the other, above 0; infinite: no limit. With a third of the
  /// spacing of a scan's samples, an isosurface loses two thirds of its triangles.
  double max_error_mm = 0.1;
  std::optional<std::size_t> faces;      ///< stops at this number of faces, if the other bounds do not stop
                                         ///< it earlier
  double max_normal_deviation_deg = 45;  ///< largest rotation of a triangle's normal by one collapse, 0..90
  double max_aspect = 10;  ///< largest allowed ratio of longest side to height for new triangles
  int max_rounds = 8;      ///< rounds of decimate(), at least 1
};

/// A coarser mesh of the same topology whose vertices are vertices of the given one: edges are collapsed in
/// the order of the error that each collapse causes. Borders of an open mesh stay as they are. A collapse
/// does not test triangles farther along the surface, and its error is a distance from planes. If a round
/// makes the mesh intersect itself, or moves a surface by more than the largest error (surface_error.h), the
/// vertices about those places are locked. The next round repeats the other collapses as far as they are
/// still allowed; the last rounds also halve the error. If `faces` is set, each round searches for its
/// collapses again. If the last round still exceeds the largest error, returns the mesh unchanged.
/// Precondition: manifold, without self-intersection; so is the result. Throws std::invalid_argument where an
/// option is out of its range, Error (Geometry) if self-intersections remain after `max_rounds`.
/// Deterministic. Cost: n log n for the first round; usually there are two to four rounds, and each later one
/// costs a fraction of the first. Source: Garland and Heckbert, "Surface simplification using quadric error
/// metrics", SIGGRAPH 1997, by OpenMesh's Decimater, halfedge collapses.
Mesh decimate(const Mesh& mesh, const DecimateOptions& options = {});

}  // namespace octotomy::brep
