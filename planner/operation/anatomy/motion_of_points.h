// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A point of a piece and its target position, LPS millimetres.
struct WantedPoint {
  std::string name;  ///< unique
  glm::dvec3 from_mm{0.0}, to_mm{0.0};
};

struct PointMotion {
  glm::dmat4 moved_from_still{1.0};
  std::vector<double> residuals_mm;  ///< distance of each moved point from its target, in the points' order
  double rms_mm = 0.0;
};

enum class PointFit {
  Best,        ///< the least sum of squared residuals
  FirstPoint,  ///< The first point is moved to its target exactly. Then the direction to the second point is
               ///< matched, then the plane through the third. Further points only have residuals.
};

/// The rigid motion that moves points to their targets. One point gives a translation. Two points do not
/// determine the rotation about their line; the smallest rotation is used (the thesis's R2 with its third
/// point from a cross product). Throws std::invalid_argument if there is no point, two points coincide, or
/// three or more points lie on one line; the message names the points. Cost: linear. Source: Ong 1992, 8.3,
/// equations 8.6 to 8.12; Horn 1987 for the best fit.
PointMotion motion_of_points(const std::vector<WantedPoint>& points, PointFit fit);

}  // namespace octotomy::planner
