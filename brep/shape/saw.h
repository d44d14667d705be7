// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// A saw cut along a line of straight pieces, swept in one direction, as wide as the blade with its set. Two
/// points define a plane cut.
struct SawCut {
  std::vector<glm::dvec3> line_mm;      ///< LPS; at least two points
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< direction in which the blade enters; any length but zero
  double depth_mm = 100.0;              ///< depth, counted from the line's point that the blade reaches first
  double kerf_mm = 1.0;                 ///< width of the cut, half on either side of the line
};

/// The solid that a saw cut removes, to be subtracted. Pieces of the line meet in mitres; its ends are
/// square. Throws std::invalid_argument if the line has fewer than two distinct points as seen along the
/// direction, if depth or kerf is not positive, or if the line turns so sharply that the kerf's sides cross.
Solid saw_blade(const SawCut& cut);

}  // namespace octotomy::brep
