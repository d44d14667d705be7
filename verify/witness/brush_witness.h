// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "verify/witness/reading.h"

namespace octotomy::verify {

/// The path of a brush, in straight pieces. The brush is a polyhedron of 32 faces with the volume of a ball,
/// or a prism of 16 sides with the volume of a disc; see witness_of_brush().
struct DrawnBrush {
  struct Disc {
    glm::dvec3 normal{0.0, 0.0, 1.0};  ///< unit, LPS
    glm::dvec3 across{1.0, 0.0, 0.0};  ///< unit, perpendicular to `normal`, through an edge of the prism
    double thickness_mm = 1.0;         ///< of the prism, half on either side of the path
  };
  std::vector<glm::dvec3> way_mm;  ///< points of the path, LPS; at least one
  double radius_mm = 1.0;
  std::optional<Disc> disc = std::nullopt;
};

/// A witness of the points that the brush covers somewhere on one of the paths. For each straight piece it
/// computes the interval of positions at which the brush covers the point, so it needs no hull. Throws
/// std::invalid_argument if there is no path or a path has no point. Cost of a point: 50 ns for each piece
/// whose box holds it.
Witness witness_of_brush(const std::vector<DrawnBrush>& ways);

}  // namespace octotomy::verify
