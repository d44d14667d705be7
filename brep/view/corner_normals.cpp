// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/view/corner_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace octotomy::brep {
namespace {

/// The unit vector; zero where rounding alone gives the vector its length.
glm::dvec3 unit(const glm::dvec3& v, double least) {
  const double length = glm::length(v);
  return length > least ? v / length : glm::dvec3(0.0);
}

}  // namespace

glm::dvec3 facet_normal(const Triangles& triangles, std::size_t facet) {
  const auto& [a, b, c] = triangles.faces[facet];
  const glm::dvec3& from = triangles.points_mm[a];
  return unit(glm::cross(triangles.points_mm[b] - from, triangles.points_mm[c] - from), 0.0);
}

std::vector<glm::dvec3> corner_normals(const Triangles& triangles) {
  std::vector<glm::dvec3> normals(triangles.points_mm.size(), glm::dvec3(0.0));
  for (std::size_t f = 0; f < triangles.faces.size(); ++f) {
    const glm::dvec3 normal = facet_normal(triangles, f);
    const auto& face = triangles.faces[f];
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& here = triangles.points_mm[face[k]];
      const glm::dvec3 next = unit(triangles.points_mm[face[(k + 1) % 3]] - here, 0.0);
      const glm::dvec3 last = unit(triangles.points_mm[face[(k + 2) % 3]] - here, 0.0);
      normals[face[k]] += normal * std::acos(std::clamp(glm::dot(next, last), -1.0, 1.0));
    }
  }
  // A sum of unit normals times angles is as long as a few radians unless the normals cancel out; a sum
  // shorter than this is only rounding.
  const double rounding = 64.0 * std::numeric_limits<double>::epsilon();
  for (glm::dvec3& normal : normals) normal = unit(normal, rounding);
  return normals;
}

}  // namespace octotomy::brep
