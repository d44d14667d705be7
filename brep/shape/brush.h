// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <stop_token>
#include <vector>

#include "brep/boolean/boolean.h"

namespace octotomy::brep {

/// A brush drawn along a polyline. A ball is a truncated icosahedron of the ball's volume, with faces at 0.96756
/// and corners at 1.04873 radii; a disc is a prism of 16 sides of the disc's volume.
struct BrushTrace {
  struct Disc {
    glm::dvec3 normal{0.0, 0.0, 1.0};  ///< unit, LPS
    glm::dvec3 across{1.0, 0.0, 0.0};  ///< unit, normal to `normal`; the prism has a corner in this direction
    double thickness_mm = 1.0;         ///< half on either side of the points
  };
  std::vector<glm::dvec3> points_mm;  ///< LPS; at least one
  double radius_mm = 1.0;             ///< greater than 0
  std::optional<Disc> disc = {};      ///< none: a ball
};

/// The union of all traces. A trace is the union of the polyhedra at its points and the convex hulls of each
/// two consecutive polyhedra. The Booleans that unite them supply the findings, shift and residual. Throws
/// std::invalid_argument if there is no trace or point, or a length is not positive and finite; otherwise as
/// boolean(). Cost: one boolean() of about 200 triangles for each point.
BooleanResult brush_solid(const std::vector<BrushTrace>& traces, const std::stop_token& stop = {});

}  // namespace octotomy::brep
