// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The least distance between two surfaces and where it is: the straight line from one to the other. Where
/// they meet it is zero and both points are one of those they have in common.
struct Gap {
  double distance_mm = 0.0;
  glm::dvec3 on_a_mm{0.0}, on_b_mm{0.0};
};

/// Exact but for rounding, edges that pass each other included; of several places equally near, one. A solid
/// within another has the distance of their surfaces. Throws std::invalid_argument where a surface has no
/// triangles. The same bits on any number of threads. Cost: linear, and the pairs of triangles
/// that are about as near as the nearest. Source: trees descended together, the nearer halves first.
Gap gap(const Triangles& a, const Triangles& b);

}  // namespace octotomy::brep
