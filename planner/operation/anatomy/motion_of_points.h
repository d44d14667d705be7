// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A point of a piece and where it is wanted, LPS millimetres.
struct WantedPoint {
  std::string name;  ///< unique
  glm::dvec3 from_mm{0.0}, to_mm{0.0};
};

struct PointMotion {
  glm::dmat4 moved_from_still{1.0};
  std::vector<double> residuals_mm;  ///< of each point: how far from where it is wanted it comes
  double rms_mm = 0.0;
};

enum class PointFit {
  Best,        ///< the least sum of squared residuals
  FirstPoint,  ///< the first point comes where it is wanted; then the direction to the second, then the plane
               ///< of the third; further points are judged only
};

/// The rigid motion that brings points where they are wanted. One point is a translation. Two points leave
/// the turn about their line open: it is the least one (the thesis's R2 with its third point made by a cross
/// product). Throws std::invalid_argument, naming points, where there is none, two points coincide, or three
/// and more lie on one line. Cost: linear. Source: Ong 1992, 8.3, equations 8.6 to 8.12; Horn 1987 for the
/// best fit.
PointMotion motion_of_points(const std::vector<WantedPoint>& points, PointFit fit);

}  // namespace octotomy::planner
