// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/mark.h"

#include <cassert>
#include <cmath>
#include <stdexcept>

#include "voxel/space/error.h"

namespace octotomy::voxel {

SightLine sight_line(const ImagePlane& plane, const glm::dvec2& p_px) {
  const glm::dvec3 start_mm = plane.lps_mm(p_px, 0.0);
  return {start_mm, glm::normalize(plane.lps_mm(p_px, 1.0) - start_mm)};
}

SightLine sight_line(const View& view, const glm::dvec2& p_mm) {
  return {p_mm.x * view.right + p_mm.y * view.up, view.look};
}

glm::dvec2 pixel_position(const ImagePlane& plane, const glm::dvec3& p_mm) {
  const double depth_mm = glm::dot(p_mm, plane.view.look) - plane.nearest_mm;
  const double spread = plane.eye ? plane.eye->spread(depth_mm) : 1.0;
  const glm::dvec2 from_centre = (plane.view.project(p_mm) - plane.centre_mm) / (spread * plane.pixel_mm);
  return glm::dvec2(plane.size_px) * 0.5 + glm::dvec2(from_centre.x, -from_centre.y);
}

SpaceMark mark_between(const SightLine& a, const SightLine& b) {
  assert(std::abs(glm::length(a.direction) - 1.0) < 1e-9 && std::abs(glm::length(b.direction) - 1.0) < 1e-9);
  // The vector between the nearest points of the lines is a multiple of this normal. The normal's length is
  // the sine of the angle between the lines.
  const glm::dvec3 normal = glm::cross(a.direction, b.direction);
  const double square = glm::dot(normal, normal);
  constexpr double least_sine = 0.1;
  if (!(square >= least_sine * least_sine))
    throw InvalidInput(
        "the two views have almost the same direction, so that marks in them do not determine the depth of a "
        "point: "
        "mark in views at least 6 degrees apart, best at right angles");
  const glm::dvec3 between = b.start_mm - a.start_mm;
  const double along_a = glm::dot(glm::cross(between, b.direction), normal) / square;
  const double along_b = glm::dot(glm::cross(between, a.direction), normal) / square;
  const glm::dvec3 on_a = a.start_mm + along_a * a.direction;
  const glm::dvec3 on_b = b.start_mm + along_b * b.direction;
  return {0.5 * (on_a + on_b), glm::distance(on_a, on_b)};
}

}  // namespace octotomy::voxel
