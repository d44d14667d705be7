// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/overhang.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

/// Tolerance of a unit vector's length and of a cosine: a face inclined by exactly the angle is no
/// overhang.
constexpr double direction_rounding = 1e-9;

std::array<glm::dvec3, 3> corners_mm(const Triangles& triangles, std::size_t face) {
  const auto& [a, b, c] = triangles.faces[face];
  return {triangles.points_mm[a], triangles.points_mm[b], triangles.points_mm[c]};
}

/// Twice the area, along the outward normal.
glm::dvec3 doubled_area(const std::array<glm::dvec3, 3>& corners) {
  return glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
}

}  // namespace

std::vector<Overhang> overhangs(const Linked& surface, const OverhangOptions& options) {
  if (!(std::abs(glm::length(options.up) - 1.0) <= direction_rounding))
    throw std::invalid_argument("overhangs: the direction away from the bed is not a unit vector");
  if (!(options.incline_deg >= 0.0 && options.incline_deg <= 90.0))
    throw InvalidInput("overhangs: the inclination must be 0 to 90 degrees");
  const Triangles& triangles = surface.triangles;
  double lowest_mm = std::numeric_limits<double>::infinity();
  for (const auto& face : triangles.faces)
    for (const std::uint32_t corner : face)
      lowest_mm = std::min(lowest_mm, glm::dot(options.up, triangles.points_mm[corner]));
  const double least_cosine = std::cos(glm::radians(options.incline_deg)) + direction_rounding;

  std::vector<char> hangs(triangles.faces.size(), 0);
  for (std::size_t face = 0; face < hangs.size(); ++face) {
    const std::array<glm::dvec3, 3> corners = corners_mm(triangles, face);
    const glm::dvec3 across = doubled_area(corners);
    const double length = glm::length(across);
    if (!(length > 0.0) || !(-glm::dot(options.up, across) > least_cosine * length)) continue;
    hangs[face] = std::any_of(corners.begin(), corners.end(), [&](const glm::dvec3& p_mm) {
      return glm::dot(options.up, p_mm) > lowest_mm + options.resting_mm;
    });
  }

  std::vector<Overhang> found;
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t first = 0; first < hangs.size(); ++first) {
    if (!hangs[first]) continue;
    Overhang patch;
    double largest_mm2 = 0.0;
    waiting.assign(1, first);
    hangs[first] = 0;
    while (!waiting.empty()) {
      const std::uint32_t face = waiting.back();
      waiting.pop_back();
      const std::array<glm::dvec3, 3> corners = corners_mm(triangles, face);
      const double area_mm2 = 0.5 * glm::length(doubled_area(corners));
      patch.area_mm2 += area_mm2;
      if (area_mm2 > largest_mm2) {
        largest_mm2 = area_mm2;
        patch.at_mm = (corners[0] + corners[1] + corners[2]) / 3.0;
      }
      for (std::uint32_t side = 3 * face; side < 3 * face + 3; ++side) {
        if (surface.opposite[side] == Linked::none) continue;
        const std::uint32_t beside = surface.opposite[side] / 3;
        if (!hangs[beside]) continue;
        hangs[beside] = 0;
        waiting.push_back(beside);
      }
    }
    found.push_back(patch);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Overhang& a, const Overhang& b) { return a.area_mm2 > b.area_mm2; });
  return found;
}

}  // namespace octotomy::brep
