// SPDX-License-Identifier: AGPL-3.0-or-later
// One point gives a translation, two are aligned by the smallest rotation, three or more are registered like
// named landmarks.
#include "planner/operation/anatomy/motion_of_points.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>

#include "brep/align/register_landmarks.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

/// The smallest rotation that maps one direction to another.
glm::dmat3 least_turn(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 axis = glm::cross(from, to);
  const double sine = glm::length(axis), cosine = glm::dot(from, to);
  if (sine > 0.0) return glm::dmat3(glm::rotate(glm::dmat4(1.0), std::atan2(sine, cosine), axis / sine));
  if (cosine > 0.0) return glm::dmat3(1.0);
  throw voxel::InvalidInput(
      "the two points would exchange their direction, which does not determine the rotation: add a third "
      "point");
}

glm::dmat4 motion_of_two(const WantedPoint& a, const WantedPoint& b, PointFit fit) {
  const glm::dvec3 from = b.from_mm - a.from_mm, to = b.to_mm - a.to_mm;
  if (glm::length(from) == 0.0 || glm::length(to) == 0.0)
    throw voxel::InvalidInput("'" + a.name + "' and '" + b.name +
                              "' coincide before or after the motion: choose two that are apart");
  const glm::dmat3 turn = least_turn(glm::normalize(from), glm::normalize(to));
  const double share = fit == PointFit::Best ? 0.5 : 0.0;  // where the fitted point lies between the first
                                                           // point (0) and the second (1)
  glm::dmat4 motion(turn);
  motion[3] = glm::dvec4(a.to_mm + share * to - turn * (a.from_mm + share * from), 1.0);
  return motion;
}

glm::dmat4 motion_of_many(const std::vector<WantedPoint>& points, PointFit fit) {
  std::vector<brep::Landmark> from, to;
  for (const WantedPoint& point : points) {
    from.push_back({point.name, point.from_mm});
    to.push_back({point.name, point.to_mm});
  }
  return brep::register_landmarks(
             from, to, fit == PointFit::Best ? brep::MotionModel::rigid : brep::MotionModel::three_points)
      .fixed_from_moving;
}

}  // namespace

PointMotion motion_of_points(const std::vector<WantedPoint>& points, PointFit fit) {
  if (points.empty()) throw voxel::InvalidInput("the motion has no points: add a point with its target");
  PointMotion found;
  if (points.size() == 1)
    found.moved_from_still[3] = glm::dvec4(points[0].to_mm - points[0].from_mm, 1.0);
  else if (points.size() == 2)
    found.moved_from_still = motion_of_two(points[0], points[1], fit);
  else
    found.moved_from_still = motion_of_many(points, fit);
  double squares = 0.0;
  for (const WantedPoint& point : points) {
    const glm::dvec3 comes(found.moved_from_still * glm::dvec4(point.from_mm, 1.0));
    found.residuals_mm.push_back(glm::distance(comes, point.to_mm));
    squares += found.residuals_mm.back() * found.residuals_mm.back();
  }
  found.rms_mm = std::sqrt(squares / static_cast<double>(points.size()));
  return found;
}

}  // namespace octotomy::planner
