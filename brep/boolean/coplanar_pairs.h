// SPDX-License-Identifier: AGPL-3.0-or-later
// Triangles of two surfaces that lie on one plane but for the rounding of their points.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

struct PointRounding {
  bool are_floats = false;  ///< all coordinates of both surfaces are floats
  double reach_mm = 0.0;    ///< the largest coordinate
  double mm = 0.0;          ///< spacing of floats, or else of doubles, at the largest coordinate
};
PointRounding point_rounding(const Triangles& a, const Triangles& b);

/// Normals that differ by less than this count as one direction. Rounding of the points turns a triangle's
/// normal by the rounding divided by the triangle's height, so triangles with a height below a million
/// roundings may be missed.
constexpr double same_direction() {
  return 1e-6;
}

/// A triangle and its plane.
struct Plane {
  glm::dvec3 normal{0.0}, on_mm{0.0};  ///< the normal's largest component is positive
  double area_mm2 = 0.0;
  std::array<glm::dvec3, 3> corners_mm;
  std::uint32_t face = 0;
};

/// The triangles that have an area and reach into the box.
std::vector<Plane> planes_of(const Triangles& surface, const glm::dvec3& low, const glm::dvec3& high);

/// Visits the pairs of triangles of which the narrower one lies within the tolerance of the wider one's
/// plane, in the order of the first list. The two triangles need not meet. Cost: n log n, and the pairs of
/// triangles whose planes lie equally far from one point.
void for_each_coplanar_pair(const std::vector<Plane>& of_a, const std::vector<Plane>& of_b,
                            double tolerance_mm,
                            const std::function<void(const Plane&, const Plane&)>& visit);

}  // namespace octotomy::brep
