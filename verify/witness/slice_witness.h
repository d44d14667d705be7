// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "verify/witness/reading.h"

namespace octotomy::verify {

/// Contours on parallel slices. Unit vectors are LPS.
struct DrawnStack {
  struct Slice {
    double position_mm = 0.0;                          ///< p . look for the points p of its plane
    std::vector<std::vector<glm::dvec2>> polygons_mm;  ///< (p . right, p . up); none: the slice is empty
  };
  glm::dvec3 look{0.0, 1.0, 0.0}, up{0.0, 0.0, 1.0}, right{1.0, 0.0, 0.0};
  std::vector<Slice> slices;  ///< in ascending order
  /// Between two slices that are not empty, the sum of the distances to both outlines decides, weighted by
  /// nearness. False: the nearer slice decides.
  bool is_interpolated = true;
  /// Largest distances of the mesh kernel's surface from the interpolated surface, in the plane and across
  /// it, because tiles are straight between sections.
  double mesh_within_mm = 0.0;
};

/// The inside of the contours by the even-odd rule: a slab for each slice, from halfway to the slice before
/// it to halfway to the next one; the outermost slabs reach as far beyond. Compares a point with the edges of the
/// slices beside it. Both sides are the same but for mesh_within_mm. Throws std::invalid_argument unless two
/// slices or more ascend. Cost of a reading: a sixteenth of the edges of two slices, about.
Witness witness_of_slices(const DrawnStack& stack);

}  // namespace octotomy::verify
