// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct OffsetOptions {
  double by_mm = 1.0;    ///< above 0 outward, below 0 inward
  double cell_mm = 1.0;  ///< edge of the lattice's cells and about that of the triangles; above 0
  Progress progress = {};
};

/// The region within by_mm of a solid (its Minkowski sum with a ball) or, if by_mm is negative, the centres
/// of balls of radius -by_mm inside the solid; empty if there are none. Walls and gaps thinner than a cell
/// may be missed. Points lie within cell_mm / 1000 of that surface, and triangles between them within a
/// chord's height, cell_mm^2 / (8 r) at a radius of curvature r; edges that stay sharp are cut off within a
/// cell. The result is closed and manifold, and no triangles intersect, because each lies in a tetrahedron of
/// its own: a solid by Construction. Throws std::invalid_argument if the solid is empty or an option is out
/// of its range, std::length_error if the lattice would have more than 2^20 cells a side or 2^23 near the
/// surface, Stopped. The same bits on any number of threads. Cost: a distance, about log n, for each corner
/// of the cells near the surface and a few for each edge that it crosses; parallel. Source: six tetrahedra
/// per cell after Kuhn. Blocks far from the surface are skipped, because a distance changes at most as much
/// as the position.
Solid offset(const Solid& solid, const OffsetOptions& options);

/// Parts that an offset's lattice missed because they are thinner than a cell.
struct MissedWalls {
  double area_share = 0.0;  ///< share of the solid's surface
  glm::dvec3 at_mm{0.0};    ///< the first such position, if there are any
};

/// The part of a solid's surface that lies outside its outward offset, or inside its inward offset, and
/// further from it than a cell. Estimated by about 20 000 samples. Cost: moved.tree().
MissedWalls missed_walls(const Solid& solid, const Solid& moved, const OffsetOptions& options);

}  // namespace octotomy::brep
