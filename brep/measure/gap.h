// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The shortest line between two surfaces. If they intersect, the distance is zero and both points are the
/// same common point.
struct Gap {
  double distance_mm = 0.0;
  glm::dvec3 on_a_mm{0.0}, on_b_mm{0.0};
};

/// The gap of two surfaces, exact up to rounding, also for edges that pass each other; if several pairs of
/// points are equally near, returns one. For a solid inside another, the distance between their surfaces.
/// Throws std::invalid_argument if a surface has no triangles. The same bits on any number of threads. Cost:
/// linear, and the pairs of triangles that are about as near as the nearest. Method: both trees are descended
/// together, nearer halves first.
Gap gap(const Triangles& a, const Triangles& b);

}  // namespace octotomy::brep
