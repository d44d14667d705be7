// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace octotomy::verify {

/// An affine map of points. Faster than a 4 x 4 matrix, because it skips the products with the constant
/// fourth row.
struct Affine {
  glm::dvec3 x, y, z, at;

  explicit Affine(const glm::dmat4& map) : x(map[0]), y(map[1]), z(map[2]), at(map[3]) {}
  glm::dvec3 operator()(const glm::dvec3& p) const { return p.x * x + p.y * y + p.z * z + at; }
};

}  // namespace octotomy::verify
