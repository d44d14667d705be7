// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <optional>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// Two solids in a frame whose axes are square to planes that faces of both share. Points that lie on such
/// a plane, except for rounding, lie on it exactly in the frame, so the faces are coplanar.
struct CommonFrame {
  Solid a, b;
  double moved_mm = 0.0;      ///< largest displacement of a point, apart from the change of frame
  double tolerance_mm = 0.0;  ///< coordinates along an axis that are nearer to each other count as one

  /// Converts a surface from the frame to LPS millimetres. A point of a solid gets its exact original
  /// coordinates back, unless it was moved by more than kept_mm. If both solids have the point, the first
  /// solid's coordinates are used. New points are merged with points within kept_mm on the same triangle.
  Triangles moved_back(const Triangles& triangles) const;

  using PointKey = std::array<double, 3>;
  glm::dmat3 lps_from_frame{1.0};
  glm::dvec3 origin_mm{0.0};
  double kept_mm = 0.0;  ///< a point is exactly restored if it lies this near to its original place
  std::map<PointKey, glm::dvec3> given_mm;
};

/// The frame of two solids that have faces on a common plane, except for the rounding of their points: to
/// doubles, or to floats if all coordinates are floats. The first axis is square to the plane of largest
/// common area. The second is square to the largest plane that is perpendicular to the first one's,
/// preferably a common plane. None if there is no common plane, if all common planes are already square to
/// the axes of LPS, if different points of a solid would become one, or if more than
/// 200 000 triangles reach into the other's box. Cost: n log n of the triangles in the common box, their
/// pairs on planes that lie equally far from one point, and n log n of all points where there is a frame.
std::optional<CommonFrame> common_frame(const Solid& a, const Solid& b);

}  // namespace octotomy::brep
