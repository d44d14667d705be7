// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct SeatingOptions {
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< unit, LPS: direction in which the part moves to its place
  double resolution_mm = 0.01;          ///< depths below this are not searched for; also the accuracy of
                                        ///< depths
  Progress progress = {};
};

/// The place where an object reaches deepest into the space that a part passes through.
struct Binding {
  glm::dvec3 at_mm{0.0};  ///< a point of the object's surface
  double depth_mm = 0.0;  ///< distance from at_mm to the nearest point outside of the space
  /// The point at_mm is inside the part while the part is `first_mm` to `last_mm` before its place; 0 is the
  /// place.
  double first_mm = 0.0, last_mm = 0.0;
};

struct Seating {
  std::optional<Binding> binding;  ///< the deepest place; none if no depth exceeds the resolution
  double swept_mm3 = 0.0;          ///< volume that the part passes through, up to the object's near end
};

/// A part is moved from outside along a direction to its place. The space that it passes through is its
/// shadow() against that direction: exact, with no triangle left out. The depth of the object in it is found
/// to `resolution_mm` by halving triangles of the object's surface whose depth may still be the largest.
/// A depth above half of the part's thickness cannot occur. Throws std::invalid_argument if the direction is not a
/// unit vector, the resolution is not above 0 or a solid is empty; Stopped. The same bits on any thread count. Cost:
/// shadow() of the part; a search in the shadow's tree for each triangle of the object within the shadow's
/// box, and for each piece of such a triangle that is larger than the distance between the two surfaces.
Seating seating(const Solid& part, const Solid& object, const SeatingOptions& options);

}  // namespace octotomy::brep
