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
  /// Edge of the lattice's cells in mm, above 0: walls and gaps thinner than it may be missed. Default: the
  /// mean side of the triangles, at most a 60th of the surface's extent and not below a 1000th.
  std::optional<double> cell_mm = std::nullopt;
  bool hull = false;  ///< only the outermost shells: cavities and what floats in them are filled
  Progress progress = {};
};

struct Enclosed {
  Solid solid;
  double cell_mm = 0.0;
  /// Of the solid's points those where the triangles have no part: they lie on sheets across holes.
  std::size_t points_across_holes = 0;
  std::size_t cavities_filled = 0;  ///< shells that `hull` took away
};

/// The points about which triangles of any kind wind more than a half: what a surface encloses although it
/// has holes, crosses itself, or has edges of one, three or contrary triangles; a closed solid by
/// Construction, as each of its triangles lies in a tetrahedron of its own. Points of the result lie on the
/// triangles given, or across holes where the winding number is a half; sharp edges are cut off within a
/// cell. A surface that is inside out encloses nothing: orient it first. Triangles with points that are not
/// finite count as holes. Throws std::invalid_argument where the cell is not above 0; Error (Geometry) where
/// nothing is enclosed or `cell_mm` gives over 2^25 lattice points near the surface; Stopped. The same bits
/// on any number of threads. Cost: a winding number, about log n, for each lattice point near the surface.
/// Source: Jacobson, Kavan, Sorkine-Hornung, "Robust
/// inside-outside segmentation using generalized winding numbers", SIGGRAPH 2013; the surface between lattice
/// points as offset() finds it.
Enclosed enclose(const Triangles& surface, const EncloseOptions& options = {});

}  // namespace octotomy::brep
