// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct EncloseOptions {
  /// Edge of the lattice's cells in mm, above 0: walls and gaps thinner than that may be missed. Default: the
  /// mean side of the triangles, but at most 1/60 and at least 1/1000 of the surface's extent.
  std::optional<double> cell_mm = std::nullopt;
  bool hull = false;  ///< keep only the outermost shells: cavities and parts inside them are filled
  Progress progress = {};
};

struct Enclosed {
  Solid solid;
  double cell_mm = 0.0;
  /// Number of the solid's points that no triangle determines: they lie on sheets across holes.
  std::size_t points_across_holes = 0;
  std::size_t cavities_filled = 0;  ///< shells that `hull` removed
};

/// The region where the winding number of arbitrary triangles exceeds 1/2: the inside of a surface even if
/// the surface has holes, crosses itself, or has edges of one, three or inconsistent triangles. The result is
/// a closed solid by Construction, because each of its triangles lies within one tetrahedron, and two in the
/// same tetrahedron share a side. Its points lie on the given triangles or, across holes, where the winding
/// number is 1/2; sharp edges are cut off within a cell. A surface that is inside out encloses nothing:
/// orient it first. Triangles with points that are not finite count as holes. Throws std::invalid_argument if
/// the cell is not above 0; Error (Geometry) if nothing is enclosed or `cell_mm` needs more than 2^25 lattice
/// points near the surface; Stopped. The same bits on any number of threads. Cost: a winding number, about
/// log n, for each lattice point near the surface. Source: Jacobson, Kavan, Sorkine-Hornung, "Robust
/// inside-outside segmentation using generalized winding numbers", SIGGRAPH 2013; the surface between lattice
/// points is found as by offset().
Enclosed enclose(const Triangles& surface, const EncloseOptions& options = {});

}  // namespace octotomy::brep
