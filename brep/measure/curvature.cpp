// SPDX-License-Identifier: AGPL-3.0-or-later
// One pass over the triangles adds to each corner its share of area, its angle, and the gradient of the area.
// The sum of gradients divided by the area is twice the mean curvature along the normal. Gradients use
// cotangents of the two other angles, computed from cross and dot products without trigonometry.
#include "brep/measure/curvature.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

struct Corner {
  double angle = 0.0, cotangent = 0.0;
};

struct Sums {
  std::vector<glm::dvec3> gradient, normal;
  std::vector<double> angle, area;
  explicit Sums(std::size_t count)
      : gradient(count, glm::dvec3(0.0)),
        normal(count, glm::dvec3(0.0)),
        angle(count, 0.0),
        area(count, 0.0) {}
};

/// The part of a triangle's area that is assigned to each corner: the part nearest to this corner. In an
/// obtuse triangle, half belongs to the obtuse corner.
std::array<double, 3> shares_of(const std::array<glm::dvec3, 3>& p, const std::array<Corner, 3>& corners,
                                double area) {
  for (std::size_t k = 0; k < 3; ++k)
    if (corners[k].cotangent < 0.0) {
      std::array<double, 3> shares;
      shares.fill(0.25 * area);
      shares[k] = 0.5 * area;
      return shares;
    }
  std::array<double, 3> shares{};
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 side = p[(k + 2) % 3] - p[(k + 1) % 3];
    const double eighth = glm::dot(side, side) * corners[k].cotangent / 8.0;
    shares[(k + 1) % 3] += eighth;
    shares[(k + 2) % 3] += eighth;
  }
  return shares;
}

void add(const Triangles& surface, const std::array<std::uint32_t, 3>& face, Sums& sums) {
  const std::array<glm::dvec3, 3> p = {surface.points_mm[face[0]], surface.points_mm[face[1]],
                                       surface.points_mm[face[2]]};
  const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double twice_area = glm::length(normal);
  if (twice_area == 0.0) return;
  std::array<Corner, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = glm::dot(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
    corners[k] = {std::atan2(twice_area, along), along / twice_area};
  }
  assert(std::max({face[0], face[1], face[2]}) < sums.area.size());
  const std::array<double, 3> shares = shares_of(p, corners, 0.5 * twice_area);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = face[k];
    sums.gradient[v] += 0.5 * (corners[(k + 2) % 3].cotangent * (p[k] - p[(k + 1) % 3]) +
                               corners[(k + 1) % 3].cotangent * (p[k] - p[(k + 2) % 3]));
    sums.normal[v] += corners[k].angle * (normal / twice_area);
    sums.angle[v] += corners[k].angle;
    sums.area[v] += shares[k];
  }
}

}  // namespace

Curvature curvature(const Mesh& mesh) {
  const Triangles surface = triangles_of(mesh);
  Sums sums(surface.points_mm.size());
  for (const auto& face : surface.faces) add(surface, face, sums);
  Curvature curvature;
  curvature.mean_per_mm.assign(surface.points_mm.size(), 0.0);
  curvature.gaussian_per_mm2.assign(surface.points_mm.size(), 0.0);
  curvature.known.assign(surface.points_mm.size(), 0);
  for (const auto vertex : mesh.vertices()) {
    const auto v = static_cast<std::size_t>(vertex.idx());
    if (mesh.is_boundary(vertex) || !(sums.area[v] > 0.0)) continue;
    curvature.known[v] = 1;
    // The gradient of area has twice the mean curvature's length and points outward where convex.
    const double sign = glm::dot(sums.gradient[v], sums.normal[v]) >= 0.0 ? 1.0 : -1.0;
    curvature.mean_per_mm[v] = sign * 0.5 * glm::length(sums.gradient[v]) / sums.area[v];
    curvature.gaussian_per_mm2[v] = (2.0 * std::numbers::pi - sums.angle[v]) / sums.area[v];
  }
  for (glm::dvec3& normal : sums.normal)
    if (const double length = glm::length(normal); length > 0.0) normal /= length;
  curvature.normals = std::move(sums.normal);
  curvature.areas_mm2 = std::move(sums.area);
  return curvature;
}

}  // namespace octotomy::brep
