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
  std::vector<double> residuals_mm;  ///< for each point, its distance from the target after the motion
  double rms_mm = 0.0;
};

enum class PointFit {
  Best,        ///< the least sum of squared residuals
  FirstPoint,  ///< the first point is moved to its target exactly, then the direction to the second is
               ///< matched, then the plane of the third; further points only have residuals
};

/// The rigid motion that moves points to their targets. One point gives a translation. Two points do not
/// determine the rotation about their line; the smallest rotation is used (the thesis's R2 with its third
/// point from a cross product). Throws std::invalid_argument, naming points, where there is none, two points
/// coincide, or three and more lie on one line. Cost: linear. Source: Ong 1992, 8.3, equations 8.6 to 8.12;
/// Horn 1987 for the best fit.
PointMotion motion_of_points(const std::vector<WantedPoint>& points, PointFit fit);

}  // namespace octotomy::planner
