// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <optional>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// Two solids in a frame whose axes are square to planes that faces of both lie on. Points that lie on such a
/// plane but for their rounding lie on it exactly there, so that such faces are coplanar.
struct CommonFrame {
  Solid a, b;
  double moved_mm = 0.0;      ///< largest move of a point beside the change of frame
  double tolerance_mm = 0.0;  ///< coordinates along an axis that are nearer to each other count as one

  /// A surface of the frame in LPS millimetres. Points of the solids that lay on the planes to the last places
  /// of doubles, or on none, are exactly what they were, of both first a's. Neighbouring new points that are
  /// nearer than that become one.
  Triangles moved_back(const Triangles& triangles) const;

  using PointKey = std::array<double, 3>;
  glm::dmat3 lps_from_frame{1.0};
  glm::dvec3 origin_mm{0.0};
  double kept_mm = 0.0;  ///< what the last places of turned points leave open
  std::map<PointKey, glm::dvec3> given_mm;
};

/// The frame of two solids that have faces on a common plane but for the rounding of their points: of doubles,
/// or of floats where all coordinates are such. The plane of most common area is square to one axis, the
/// largest of those square to it, of common ones first, to the second. None where no plane is common, or all of
/// them are square to the axes of LPS exactly already, where a solid's points are nearer to each other than
/// their rounding, and where more than 200 000 triangles reach into the other's box. Cost: n log n of the triangles in the
/// common box, their pairs on planes that lie equally far from one point, and n log n of all points where there
/// is a frame.
std::optional<CommonFrame> common_frame(const Solid& a, const Solid& b);

}  // namespace octotomy::brep
