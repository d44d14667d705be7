// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <stop_token>
#include <vector>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// A point of a solid's surface and the unit normal there, outward. LPS millimetres.
struct SurfacePoint {
  glm::dvec3 p_mm{0.0}, normal{0.0};
};

/// The thickness of a solid at a surface point, by two definitions that differ where walls are not parallel.
struct Thickness {
  /// Distance straight inward along the normal to the next point of the surface.
  double ray_mm = 0.0;
  /// Diameter of the largest ball that touches the surface at the point from inside and contains no other
  /// point of the surface.
  double ball_mm = 0.0;
};

struct ThicknessOptions {
  /// Surface within this angle of the point, seen from the ball's centre, belongs to the point's own sheet,
  /// 1..120. With a smaller angle, flatter ridges limit the ball, and so do the facets of a curved sheet:
  /// facets of depth h limit the radius to about h / (1 - cos angle).
  double least_angle_deg = 30.0;
  std::function<void(double)> progress = {};  ///< is called with 0..1, from the calling thread
  std::stop_token stop = {};
};

/// The thickness at each point. A ball begins with the ray as its diameter and shrinks until no other sheet
/// lies in it. Towards a sharp edge balls shrink to nothing, because a ball there touches both sides of the
/// edge. Rays are exact up to rounding; balls are as accurate as those of InscribedBalls::touching().
/// Precondition: a point lies on the surface. Throws std::invalid_argument if the solid is empty, the angle
/// is out of its range, or a ray leaves without meeting the surface, naming the point; Stopped. The same bits
/// on any number of threads. Cost: n log n for the tree, about log n a point; parallel. Source: Ma, Bae and
/// Choi, "3D medial axis point approximation using nearest neighbors and the normal field", The Visual
/// Computer 28, 2012, here with triangles instead of points, and with all sheets tested at each step.
std::vector<Thickness> thickness(const Solid& solid, const std::vector<SurfacePoint>& points,
                                 const ThicknessOptions& options = {});

}  // namespace octotomy::brep
