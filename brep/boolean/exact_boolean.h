// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <stop_token>

#include "brep/boolean/boolean.h"
#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// How work is watched and ended.
struct Watch {
  std::function<void(double)> progress = {};  ///< is called with 0..1
  std::stop_token stop = {};
};

struct ExactBoolean {
  Mesh mesh;  ///< rounded to doubles at the end; ask health() whether that made it meet itself
  /// Exact volumes, rounded for reading: of the operands, their union and intersection, and the result.
  double a_mm3 = 0.0, b_mm3 = 0.0, united_mm3 = 0.0, intersection_mm3 = 0.0, result_mm3 = 0.0;
  double rounding_mm3 = 0.0;  ///< the rounded mesh's volume less the exact one
  std::size_t points = 0;     ///< of the result, that rounding moved: new ones that no doubles name
};

/// As boolean(), with every new point an exact number, and proof: |A| + |B| = |A u B| + |A n B| and, of a
/// difference, |A| = |A - B| + |A n B| hold as rational numbers, else std::runtime_error tells by how much
/// they miss. Nothing is ever shifted: operands that touch so that a wanted result would not be manifold are
/// refused by std::runtime_error, as is one that is stopped. Throws std::invalid_argument where an operand is
/// open or inside out. Cost: four times boolean()'s whole corefinement, and the volumes some 100 us a
/// triangle. Source: CGAL's corefinement over its kernel of exact constructions.
ExactBoolean exact_boolean(const Mesh& a, Operation operation, const Mesh& b, const Watch& watch = {});

}  // namespace octotomy::brep
