// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct OffsetOptions {
  double by_mm = 1.0;  ///< length of the offset: above 0 outward, below 0 inward
  /// Approximate edge length of the smallest triangles on parts that the offset rounds; above 0. Sharp edges
  /// get triangles of a quarter of this length, flat and gently curved parts larger triangles.
  double cell_mm = 1.0;
  Progress progress = {};
};

/// The largest distance between triangles and the offset surface, away from the triangles' points: the height
/// of a chord of sqrt(2) cells at a radius of the offset's own length, and at most a 16th of a cell. The mean
/// distance over a smooth surface is at most a third of this.
double offset_tolerance_mm(const OffsetOptions& options);

/// The surface of all points within by_mm of a solid, its Minkowski sum with a ball. If by_mm is negative,
/// the surface of the points at least that deep inside, which are the possible centres of such balls within
/// the solid; empty if there are none. Walls and clefts thinner than a cell may be missed. Points lie within
/// cell_mm / 1000 of that surface, and triangles between them within offset_tolerance_mm(); sharp edges are
/// cut off within a quarter of a cell. The result is closed and manifold, and no triangles intersect, because
/// each lies within one tetrahedron, and two in the same tetrahedron share a side: a solid by Construction.
/// Throws std::invalid_argument if the solid is empty or an option is out of its range, std::length_error if
/// a side would have more than 2^17 cells or the surface passes more than 2^22 tetrahedra, Stopped. The same
/// bits on any number of threads. Cost: grows with the result's triangles, about ten distances of log n each
/// for one triangle; parallel. Sources: see bisected_lattice.h. Tetrahedra far from the surface are skipped,
/// because distances change by at most the distance between points.
Solid offset(const Solid& solid, const OffsetOptions& options);

/// The wall around a surface of any kind, even open or crossing itself: all points within by_mm, above 0, of
/// its triangles. A closed surface becomes a hollow shell. Preconditions: at least one triangle, all points
/// finite. Guarantees, throws and costs as offset(), also std::invalid_argument if by_mm is not above 0;
/// walls of less than two cells may be missed.
Solid thickened(const Triangles& surface, const OffsetOptions& options);

/// Parts that an offset's lattice missed because they are thinner than a cell.
struct MissedWalls {
  double area_share = 0.0;  ///< share of the solid's surface
  glm::dvec3 at_mm{0.0};    ///< the first such position, if there are any
};

/// The part of a solid's surface that lies outside its outward offset, or inside its inward offset, by more
/// than a cell. Estimated from about 20 000 samples. Cost: moved.tree().
MissedWalls missed_walls(const Solid& solid, const Solid& moved, const OffsetOptions& options);

}  // namespace octotomy::brep
