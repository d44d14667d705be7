// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/solid/expression.h"

namespace octotomy::voxel {

/// One stroke of a brush, along a polyline. At each point the brush is a convex polyhedron: for a ball, one
/// with the ball's volume; for a slab, a regular prism. Between two points it is the convex hull of the
/// polyhedra at both points.
struct BrushStroke {
  /// A brush that is a thick disc, represented by a prism with 16 sides and the disc's volume.
  struct Slab {
    glm::dvec3 normal{0, 0, 1};  ///< unit, LPS
    glm::dvec3 across{1, 0, 0};  ///< unit vector at a right angle to `normal`, towards a corner of the prism
    double thickness_mm = 1.0;   ///< thickness of the disc, half of it on either side of the points
  };
  std::vector<glm::dvec3> points_mm;        ///< LPS; at least one
  double radius_mm = 1.0;                   ///< above 0
  std::optional<Slab> slab = std::nullopt;  ///< none: a ball
};

/// The union of the strokes, as an expression of half-spaces. A ball is a truncated icosahedron with its
/// faces at 0.96756 radii from the centre and its corners at 1.04873. Throws std::invalid_argument if there
/// is no stroke, a stroke has no point, or a length is not positive and finite. Cost: about 50 half-spaces
/// for each point.
Expression brush(const std::vector<BrushStroke>& strokes);

}  // namespace octotomy::voxel
