// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/saw.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "brep/mesh/error.h"
#include "brep/shape/prism.h"

namespace octotomy::brep {
namespace {

glm::dvec2 left_of(const glm::dvec2& along) {
  assert(glm::length(along) > 0.0);
  return glm::dvec2(-along.y, along.x) / glm::length(along);
}

/// The line moved to its left by `side`; the moved pieces meet at the corners.
std::vector<glm::dvec2> moved_aside(const std::vector<glm::dvec2>& line, double side) {
  assert(line.size() >= 2);
  std::vector<glm::dvec2> moved;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const glm::dvec2 before = left_of(k > 0 ? line[k] - line[k - 1] : line[1] - line[0]);
    const glm::dvec2 after = left_of(k + 1 < line.size() ? line[k + 1] - line[k] : line[k] - line[k - 1]);
    // The corner's point lies at the distance `side` from both edges: m . before = m . after = side.
    const double share = 1.0 + glm::dot(before, after);
    if (!(share > 0.0))
      throw InvalidInput("saw_blade: the line turns back on itself at point " + std::to_string(k));
    moved.push_back(line[k] + side * (before + after) / share);
  }
  return moved;
}

}  // namespace

Solid saw_blade(const SawCut& cut) {
  if (!(glm::length(cut.direction) > 0.0)) throw InvalidInput("saw_blade: the direction has length 0");
  if (!(cut.depth_mm > 0.0) || !(cut.kerf_mm > 0.0))
    throw InvalidInput("saw_blade: depth and kerf must be above 0 mm");
  Prism prism;
  prism.look = glm::normalize(cut.direction);
  // Any axis that is not parallel to the direction is suitable.
  const glm::dvec3 aside = std::abs(prism.look.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  prism.right = glm::normalize(glm::cross(prism.look, aside));
  prism.up = glm::cross(prism.right, prism.look);

  std::vector<glm::dvec2> line;
  prism.from_mm = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p : cut.line_mm) {
    const glm::dvec2 q(glm::dot(p, prism.right), glm::dot(p, prism.up));
    if (line.empty() || q != line.back()) line.push_back(q);
    prism.from_mm = std::min(prism.from_mm, glm::dot(p, prism.look));
  }
  if (line.size() < 2)
    throw InvalidInput("saw_blade: the line needs two points that are distinct as seen along the direction");
  prism.to_mm = prism.from_mm + cut.depth_mm;

  std::vector<glm::dvec2> outline = moved_aside(line, -0.5 * cut.kerf_mm);
  const std::vector<glm::dvec2> other = moved_aside(line, 0.5 * cut.kerf_mm);
  outline.insert(outline.end(), other.rbegin(), other.rend());
  prism.polygons_mm = {outline};
  return solid_of(prism);
}

}  // namespace octotomy::brep
