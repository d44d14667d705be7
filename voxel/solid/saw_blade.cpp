// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/saw_blade.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

/// A view along the saw's direction, with arbitrary other axes.
View view_along(const glm::dvec3& direction) {
  View view;
  view.look = glm::normalize(direction);
  int least = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(view.look[axis]) < std::abs(view.look[least])) least = axis;
  glm::dvec3 up(0.0);
  up[least] = 1.0;
  view.up = glm::normalize(up - view.look * glm::dot(up, view.look));
  view.right = glm::cross(view.look, view.up);
  return view;
}

/// The corner where the sides of two pieces meet, each half a kerf beside its piece. It lies on the bisector
/// of the pieces' normals.
glm::dvec2 mitre(const glm::dvec2& before, const glm::dvec2& after, double half_kerf_mm) {
  const glm::dvec2 sum = before + after;
  const double square = glm::dot(sum, sum);
  // If the sum is zero except for rounding errors, the pieces run in opposite directions.
  if (!(square > 64.0 * std::numeric_limits<double>::epsilon()))
    throw InvalidInput("the saw's line turns back on itself: remove the point where it turns");
  return sum * (2.0 * half_kerf_mm / square);
}

}  // namespace

RegionMask saw_blade_sides(const SawLine& saw) {
  if (!(glm::length(saw.direction) > 0.0))
    throw InvalidInput("the saw has no direction: its vector must not be (0, 0, 0)");
  const View view = view_along(saw.direction);
  std::vector<glm::dvec2> line;
  for (const glm::dvec3& p_mm : saw.line_mm)
    if (const glm::dvec2 q = view.project(p_mm); line.empty() || q != line.back()) line.push_back(q);
  if (line.size() < 2)
    throw InvalidInput(
        "the saw's line needs two points that do not coincide as seen along the saw's direction");
  const auto normal = [&](std::size_t piece) {
    const glm::dvec2 along = glm::normalize(line[piece + 1] - line[piece]);
    return glm::dvec2(along.y, -along.x);
  };
  std::vector<glm::dvec2> outline(2 * line.size());
  for (std::size_t k = 0; k < line.size(); ++k) {
    const glm::dvec2 aside =
        mitre(normal(k == 0 ? 0 : k - 1), normal(std::min(k, line.size() - 2)), 0.5 * saw.kerf_mm);
    outline[k] = line[k] + aside;
    outline[outline.size() - 1 - k] = line[k] - aside;
  }
  return {{Region{view, {outline}}}};
}

Expression saw_blade(const SawLine& saw) {
  const RegionMask sides = saw_blade_sides(saw);
  const glm::dvec3 look = sides.regions.front().view.look;
  double from_mm = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p_mm : saw.line_mm) from_mm = std::min(from_mm, glm::dot(p_mm, look));
  return Expression(sides) & Expression(HalfSpace{look, from_mm + saw.depth_mm}) &
         Expression(HalfSpace{-look, -from_mm});
}

}  // namespace octotomy::voxel
