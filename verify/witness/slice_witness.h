// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "verify/witness/reading.h"

namespace octotomy::verify {

/// A stack of contours on parallel slices. The vectors are unit vectors in LPS.
struct DrawnStack {
  struct Slice {
    double position_mm = 0.0;                          ///< p . look for all points p of the slice's plane
    std::vector<std::vector<glm::dvec2>> polygons_mm;  ///< in (p . right, p . up); none: empty slice
  };
  glm::dvec3 look{0.0, 1.0, 0.0}, up{0.0, 0.0, 1.0}, right{1.0, 0.0, 0.0};
  std::vector<Slice> slices;  ///< in ascending order
  /// Between two slices that are not empty, the sum of the signed distances to both outlines decides,
  /// weighted by nearness. False: the nearer slice decides.
  bool is_interpolated = true;
  /// Largest distances of the mesh kernel's surface from the interpolated surface, in the plane and across
  /// it. They differ because tiles are straight between sections.
  double mesh_within_mm = 0.0;
};

/// A witness of the inside of the contours by the even-odd rule: a slab for each slice, from halfway to the
/// slice before it to halfway to the next one. The outermost slabs extend equally far beyond their slice. A
/// point is compared with the edges of the slices beside it. The sides of both kernels are the same except
/// for mesh_within_mm. Throws std::invalid_argument unless there are two slices or more in ascending order.
/// Cost of a reading: about a sixteenth of the edges of two slices.
Witness witness_of_slices(const DrawnStack& stack);

}  // namespace octotomy::verify
