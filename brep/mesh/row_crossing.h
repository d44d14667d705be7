// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <utility>

// Crossings of lines along x and a triangle, for volumes and inside tests. The point where a row meets a side
// is computed from the side's lower end, for every triangle at that side, and the sign of a crossing follows
// from the side's direction. Lines through a closed surface therefore leave it as often as they enter it.

namespace octotomy::brep {

/// The lines along x at one z that cross a triangle: those at y from low_y up to, not including, high_y.
struct RowCrossing {
  double low_y = 0.0, low_x = 0.0;    ///< the point at which the row meets the side of lower y
  double high_y = 0.0, high_x = 0.0;  ///< the point at which the row meets the other side
  int enters = 1;                     ///< 1 where lines enter a closed surface there, -1 where they leave it

  bool has(double y) const { return y >= low_y && y < high_y; }
  /// The x at which the line at y crosses. Precondition: has(y).
  double x_at(double y) const { return low_x + (y - low_y) / (high_y - low_y) * (high_x - low_x); }
};

/// The crossing of the row at z; none if it misses the triangle.
inline std::optional<RowCrossing> row_crossing(const std::array<glm::dvec3, 3>& corners, double z) {
  struct Meeting {
    double y = 0.0, x = 0.0;
    bool upward = false;
  };
  std::array<Meeting, 3> met;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &from = corners[k], &to = corners[(k + 1) % 3];
    if ((from.z <= z) == (to.z <= z)) continue;
    const bool upward = from.z <= z;
    const glm::dvec3 &low = upward ? from : to, &high = upward ? to : from;
    const double share = (z - low.z) / (high.z - low.z);
    met[count++] = {low.y + share * (high.y - low.y), low.x + share * (high.x - low.x), upward};
  }
  assert(count == 0 || count == 2);
  if (count < 2) return std::nullopt;
  if (met[1].y < met[0].y) std::swap(met[0], met[1]);
  // A triangle that is counter-clockwise in the plane of y and z has a left side that runs down, and faces
  // +x: the line leaves there.
  return RowCrossing{met[0].y, met[0].x, met[1].y, met[1].x, met[0].upward ? 1 : -1};
}

/// The area of a triangle's projection along x.
inline double shadow_mm2(const std::array<glm::dvec3, 3>& corners) {
  const glm::dvec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
  return 0.5 * std::abs(u.y * v.z - u.z * v.y);
}

}  // namespace octotomy::brep
