// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// A region swept along a direction: closed polygons in the plane of `right` and `up` (a point is
/// right * u + up * v, even-odd rule, so inner polygons are holes) from depth `from_mm` to `to_mm` along
/// `look`. The three are orthonormal LPS vectors with right = look x up.
struct Prism {
  glm::dvec3 look{0, 1, 0}, up{0, 0, 1}, right{1, 0, 0};
  std::vector<std::vector<glm::dvec2>> polygons_mm;
  double from_mm = 0.0;
  double to_mm = 1.0;
};

/// The solid of a prism, by Construction; oriented outward for any winding of the polygons. A point that
/// repeats its predecessor, or a last point that repeats the first, is counted once. Throws
/// std::invalid_argument, which names the polygon, if polygons cross or touch each other or themselves (the
/// solid would not be manifold) or have fewer than three points or no area; also if the frame is not
/// orthonormal or the depths are not in order. Cost: n log n for n points, more where many sides overlap in
/// u.
Solid solid_of(const Prism& prism);

}  // namespace octotomy::brep
