// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "planner/operation/table/field.h"

namespace octotomy::planner {

/// A saw cut: a line of straight pieces swept in one direction, as wide as the blade.
struct Saw {
  ObjectName object;
  std::vector<glm::dvec3> line_mm;  ///< LPS; two points or more
  glm::dvec3 direction{0, 1, 0};    ///< in which the blade goes in, LPS; of any length
  double depth_mm = 100.0;          ///< from the line's point that the blade meets first
  double kerf_mm = 1.0;             ///< width of what is sawn away, half on either side of the line
};

}  // namespace octotomy::planner
