// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

struct OverhangOptions {
  glm::dvec3 up{0.0, 0.0, 1.0};  ///< unit, LPS: from the printer's bed to the layers above
  /// A face that looks down is an overhang if its angle to the bed is below this, 0..90 degrees.
  double incline_deg = 45.0;
  /// Faces within this height above the lowest point rest on the bed.
  double resting_mm = 0.1;
};

/// Overhanging triangles that are connected across edges.
struct Overhang {
  double area_mm2 = 0.0;
  glm::dvec3 at_mm{0.0};  ///< middle of the overhang's largest triangle
};

/// The overhangs of a surface, largest first, equal ones by their first triangle. Triangles without area are
/// not overhangs. Exact but for rounding. Throws std::invalid_argument if `up` is not a unit vector or the
/// angle is out of its range. Cost: linear.
std::vector<Overhang> overhangs(const Linked& surface, const OverhangOptions& options);

}  // namespace octotomy::brep
