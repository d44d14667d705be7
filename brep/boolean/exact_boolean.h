// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/boolean/boolean.h"
#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct ExactBoolean {
  Solid solid;  ///< rounded to doubles at the end; check with health() whether it then intersects itself
  /// Exact volumes of the operands, their union, their intersection and the result, each rounded to a double.
  double a_mm3 = 0.0, b_mm3 = 0.0, united_mm3 = 0.0, intersection_mm3 = 0.0, result_mm3 = 0.0;
  double rounding_mm3 = 0.0;  ///< volume of the rounded mesh minus the exact volume
  std::size_t points = 0;     ///< points of the result that rounding moved: new ones that doubles cannot
                              ///< represent
};

/// boolean() with exact numbers for every new point, and a proof: |A| + |B| = |A u B| + |A n B| and, for a
/// difference, |A| = |A - B| + |A n B| hold as rational numbers; otherwise Error (Geometry) states the
/// difference. If the union is not manifold and not wanted, |B| = |B - A| + |A n B| replaces the first
/// equation. The result is also checked by the lines of boolean(). Never shifts an operand: throws Error
/// (Geometry) if the wanted result, or another one that the proof needs, would not be manifold, or if an
/// operand touches itself within the other's box. Also throws Stopped, and std::invalid_argument if an
/// operand is inside out. Cost: four times boolean()'s corefinement of whole surfaces, twice that if the
/// union is not manifold, and about 100 us per triangle for the volumes. Source: CGAL's corefinement over its
/// kernel of exact constructions.
ExactBoolean exact_boolean(const Solid& a, Operation operation, const Solid& b,
                           const Progress& progress = {});

}  // namespace octotomy::brep
