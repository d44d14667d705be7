// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/boolean/boolean.h"
#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct ExactBoolean {
  Solid solid;  ///< rounded to doubles at the end; ask health() whether that made it meet itself
  /// Exact volumes, rounded for reading: of the operands, their union and intersection, and the result.
  double a_mm3 = 0.0, b_mm3 = 0.0, united_mm3 = 0.0, intersection_mm3 = 0.0, result_mm3 = 0.0;
  double rounding_mm3 = 0.0;  ///< the rounded mesh's volume less the exact one
  std::size_t points = 0;     ///< of the result, that rounding moved: new ones that no doubles name
};

/// As boolean(), with every new point an exact number, and proof: |A| + |B| = |A u B| + |A n B| and, of a
/// difference, |A| = |A - B| + |A n B| hold as rational numbers, else Error (Geometry) states by how much
/// they miss. Where the union would not be manifold and is not wanted, |B| = |B - A| + |A n B| stands in for
/// the first. The lines that check boolean() check this result, too. Nothing is ever shifted: throws Error
/// (Geometry) if the wanted result, or another one that the proof needs, would not be manifold. Throws Stopped
/// too, and std::invalid_argument if an operand is inside out. Cost: four times boolean()'s whole
/// corefinement, twice that where the union is not manifold, and the volumes some 100 us a triangle. Source:
/// CGAL's corefinement over its kernel of exact constructions.
ExactBoolean exact_boolean(const Solid& a, Operation operation, const Solid& b,
                           const Progress& progress = {});

}  // namespace octotomy::brep
