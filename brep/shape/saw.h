// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// A cut as a saw makes it: along a line of straight pieces, swept in one direction, as wide as the blade and
/// its set. Two points make a plane cut.
struct SawCut {
  std::vector<glm::dvec3> line_mm;      ///< LPS; at least two points
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< the way the blade goes in; any length but zero
  double depth_mm = 100.0;              ///< from that of the line's points which the blade meets first
  double kerf_mm = 1.0;                 ///< width of what is sawn away, half on either side of the line
};

/// The solid that a saw cut takes away: what to subtract. Pieces of the line meet in mitres; its ends are
/// square. Throws std::invalid_argument if the line has fewer than two points apart as seen along the
/// direction, depth or kerf is not positive, or the line turns so sharply for the kerf that its sides cross.
Solid saw_blade(const SawCut& cut);

}  // namespace octotomy::brep
