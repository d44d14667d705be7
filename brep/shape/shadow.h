// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// The largest p . direction of a solid's points, in mm for a unit direction. Precondition: not empty.
double far_end_mm(const Solid& solid, const glm::dvec3& direction);

struct ShadowOptions {
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< unit, LPS: direction in which a part is put on
  double end_mm = 0.0;                  ///< position along `direction` of the plane at which the shadow ends
  Progress progress = {};
};

struct Shadow {
  Solid solid;
  std::size_t seen = 0;  ///< triangles of the object that are visible along the direction
};

/// The points of an object and all points behind it as seen along a direction, up to a plane across that
/// direction: the space that nothing can reach by moving along the direction from outside. The object's
/// cavities belong to the shadow. Exact but for rounding: the surface consists of the parts of the object's
/// triangles that are seen first, with those triangles' own points, of walls along the direction below the
/// edges at which the view jumps, and of the plane. No triangle is left out or simplified. Points where edges
/// cross in the view are rounded to doubles, so the proof is Rounded; the surface is closed for any rounding.
///
/// Where `end_mm` is less than the far end of the solid, the plane is at the far end. The empty set has an
/// empty shadow. Throws std::invalid_argument if the direction is not a unit vector or the end is not
/// finite; Stopped. The same bits on any thread count. Cost: n log n, where n counts the triangles that face
/// the direction and are not surely hidden, and the crossings of their edges in the view.
Shadow shadow(const Solid& solid, const ShadowOptions& options);

}  // namespace octotomy::brep
