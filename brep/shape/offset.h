// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct OffsetOptions {
  double by_mm = 1.0;  ///< above 0 outward, below 0 inward
  /// About the edge of the smallest triangles on parts that are rounded by the offset; above 0. Sharp edges
  /// get a quarter of it, flat and gently curved parts larger ones.
  double cell_mm = 1.0;
  Progress progress = {};
};

/// How far triangles may lie from the offset surface between their points: the height of a chord of sqrt(2)
/// cells at a radius of the offset's own length, and at most a 16th of a cell. On the mean over a smooth
/// surface at most a third of it.
double offset_tolerance_mm(const OffsetOptions& options);

/// The surface of all points within by_mm of a solid, its sum with a ball; or for by_mm below 0 of those that
/// far inside, what a ball within can reach the middle of; empty if there are none. Walls and clefts thinner
/// than a cell may be missed. Points lie within cell_mm / 1000 of that surface, and triangles between them
/// within offset_tolerance_mm(); edges that are sharp come out cut off within a quarter of a cell. The result
/// is closed and manifold, and no triangles intersect, as each lies in a tetrahedron of its own: a solid by
/// Construction. Throws std::invalid_argument if the solid is empty or an option is out of its range,
/// std::length_error if a side would have more than 2^17 cells or the surface passes more than 2^22
/// tetrahedra, Stopped. The same bits on any number of threads. Cost: grows with the triangles of the result,
/// about ten distances of log n each for one; parallel. Sources: see bisected_lattice.h; tetrahedra far from
/// the surface are passed over, as distances change no faster than places do.
Solid offset(const Solid& solid, const OffsetOptions& options);

/// A surface of any kind, open or crossing itself, made a wall: all points within by_mm, above 0, of its
/// triangles. A closed surface becomes a hollow shell. Preconditions: at least one triangle, all points finite.
/// Guarantees, throws and costs as offset(), also std::invalid_argument where by_mm is not above 0; walls of
/// less than two cells may be missed.
Solid thickened(const Triangles& surface, const OffsetOptions& options);

/// Parts that an offset's lattice missed because they are thinner than a cell.
struct MissedWalls {
  double area_share = 0.0;  ///< share of the solid's surface
  glm::dvec3 at_mm{0.0};    ///< the first such position, if there are any
};

/// The part of a solid's surface that lies outside its outward offset, or inside its inward offset, and
/// further from it than a cell. Estimated by about 20 000 samples. Cost: moved.tree().
MissedWalls missed_walls(const Solid& solid, const Solid& moved, const OffsetOptions& options);

}  // namespace octotomy::brep
