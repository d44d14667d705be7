// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/arch_band.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace octotomy::planner {
namespace {

constexpr double curve_step_mm = 0.5;

/// A point of the centripetal Catmull-Rom spline between b and c, at `share` of the way; a and d are the
/// neighbouring points.
glm::dvec2 on_spline(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d,
                     double share) {
  const auto knot = [](double from, const glm::dvec2& p, const glm::dvec2& q) {
    return from + std::sqrt(std::max(glm::distance(p, q), 1e-6));
  };
  const double t0 = 0.0, t1 = knot(t0, a, b), t2 = knot(t1, b, c), t3 = knot(t2, c, d);
  const double t = t1 + share * (t2 - t1);
  const auto between = [&](const glm::dvec2& p, const glm::dvec2& q, double from, double to) {
    return ((to - t) * p + (t - from) * q) / (to - from);
  };
  const glm::dvec2 ab = between(a, b, t0, t1), bc = between(b, c, t1, t2), cd = between(c, d, t2, t3);
  return between(between(ab, bc, t0, t2), between(bc, cd, t1, t3), t1, t2);
}

/// A spline through the points as a polyline, with steps of at most curve_step_mm. Beyond either end a
/// further point is assumed that continues the outermost segment straight.
std::vector<glm::dvec2> curve_through(const std::vector<glm::dvec2>& points_mm) {
  std::vector<glm::dvec2> p{2.0 * points_mm[0] - points_mm[1]};
  p.insert(p.end(), points_mm.begin(), points_mm.end());
  p.push_back(2.0 * points_mm.back() - points_mm[points_mm.size() - 2]);
  std::vector<glm::dvec2> curve;
  for (std::size_t i = 1; i + 2 < p.size(); ++i) {
    const int steps = std::max(1, static_cast<int>(std::ceil(glm::distance(p[i], p[i + 1]) / curve_step_mm)));
    for (int step = 0; step < steps; ++step)
      curve.push_back(on_spline(p[i - 1], p[i], p[i + 1], p[i + 2], static_cast<double>(step) / steps));
  }
  curve.push_back(points_mm.back());
  return curve;
}

/// Whether a point half a width beside the curve's point `i` lies beyond the centre of a bend, because it is
/// nearer to another point of the curve. For points more than half the width away along the curve, distances
/// that are larger by up to a hundredth also count as nearer, so that the two sides of a bend do not cross.
bool is_beyond_bend(const std::vector<glm::dvec2>& curve, std::size_t i, const glm::dvec2& p_mm,
                    double half_mm) {
  constexpr double rounding = 1e-6;
  const auto near = static_cast<std::size_t>(half_mm / curve_step_mm);
  for (std::size_t other = 0; other < curve.size(); ++other) {
    const bool is_near = (other > i ? other - i : i - other) <= near;
    if (glm::distance(p_mm, curve[other]) < half_mm * (is_near ? 1.0 - rounding : 1.01)) return true;
  }
  return false;
}

/// Adds the inner points of a half disc's arc. The arc begins on the left of the curve's last point or on the
/// right of its first point.
void add_arc(const glm::dvec2& middle_mm, const glm::dvec2& from, std::vector<glm::dvec2>& outline_mm) {
  constexpr int sides = 24;
  for (int i = 1; i < sides; ++i) {
    const double turn = std::acos(-1.0) * i / sides;
    const glm::dvec2 onward(from.y, -from.x);
    outline_mm.push_back(middle_mm + std::cos(turn) * from + std::sin(turn) * onward);
  }
}

std::vector<glm::dvec2> outline_of(const std::vector<glm::dvec2>& curve, double width_mm, bool is_round) {
  const double half_mm = 0.5 * width_mm;
  std::vector<glm::dvec2> left, right;
  const auto aside_at = [&](std::size_t i) {
    const glm::dvec2 along =
        glm::normalize(curve[std::min(i + 1, curve.size() - 1)] - curve[i == 0 ? 0 : i - 1]);
    return glm::dvec2(-along.y, along.x);
  };
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const glm::dvec2 aside = aside_at(i);
    for (const auto& [side, sign] : {std::pair(&left, 1.0), std::pair(&right, -1.0)})
      if (const glm::dvec2 p_mm = curve[i] + sign * half_mm * aside; !is_beyond_bend(curve, i, p_mm, half_mm))
        side->push_back(p_mm);
  }
  if (is_round) add_arc(curve.back(), half_mm * aside_at(curve.size() - 1), left);
  left.insert(left.end(), right.rbegin(), right.rend());
  if (is_round) add_arc(curve.front(), -half_mm * aside_at(0), left);
  return left;
}

}  // namespace

ArchFrame arch_frame(const std::vector<glm::dvec3>& points_mm, const glm::dvec3& towards) {
  glm::dvec3 middle(0.0), doubled_area(0.0);
  for (const glm::dvec3& p_mm : points_mm) middle += p_mm / static_cast<double>(points_mm.size());
  double length_mm = 0.0;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    const glm::dvec3 &from = points_mm[i], &to = points_mm[(i + 1) % points_mm.size()];
    doubled_area += glm::cross(from - middle, to - middle);
    length_mm = std::max(length_mm, glm::distance(from, points_mm.front()));
  }
  if (!(glm::length(doubled_area) > length_mm * length_mm / 50.0))
    throw std::runtime_error(
        "the points along the arch lie on one line: choose at least three, from one end of the arch over its "
        "front to the other");
  ArchFrame frame;
  frame.look = glm::normalize(doubled_area);
  if (glm::dot(frame.look, towards) < 0.0) frame.look = -frame.look;
  int least = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(frame.look[axis]) < std::abs(frame.look[least])) least = axis;
  glm::dvec3 up(0.0);
  up[least] = 1.0;
  frame.up = glm::normalize(up - frame.look * glm::dot(up, frame.look));
  frame.right = glm::cross(frame.look, frame.up);
  frame.height_mm = glm::dot(middle, frame.look);
  for (const glm::dvec3& p_mm : points_mm) {
    frame.points_mm.push_back(frame.project(p_mm));
    frame.off_plane_mm = std::max(frame.off_plane_mm, std::abs(glm::dot(p_mm, frame.look) - frame.height_mm));
  }
  return frame;
}

std::vector<glm::dvec2> band_outline(const std::vector<glm::dvec2>& points_mm, double width_mm) {
  return outline_of(curve_through(points_mm), width_mm, false);
}

std::vector<glm::dvec2> round_band_outline(const std::vector<glm::dvec2>& points_mm, double width_mm) {
  return outline_of(curve_through(points_mm), width_mm, true);
}

double curve_length_mm(const std::vector<glm::dvec2>& points_mm) {
  const std::vector<glm::dvec2> curve = curve_through(points_mm);
  double length_mm = 0.0;
  for (std::size_t i = 1; i < curve.size(); ++i) length_mm += glm::distance(curve[i - 1], curve[i]);
  return length_mm;
}

std::vector<glm::dvec2> longer_by(std::vector<glm::dvec2> points_mm, double by_mm) {
  const auto outward = [&](const glm::dvec2& end, const glm::dvec2& beside) {
    return end + by_mm * glm::normalize(end - beside);
  };
  const glm::dvec2 first = outward(points_mm[0], points_mm[1]),
                   last = outward(points_mm.back(), points_mm[points_mm.size() - 2]);
  points_mm.front() = first;
  points_mm.back() = last;
  return points_mm;
}

brep::Solid Slab::solid() const {
  brep::Prism prism{frame.look, frame.up, frame.right, {outline_mm}, low_mm, high_mm};
  return brep::solid_of(prism);
}

voxel::RegionMask Slab::sides() const {
  return {{voxel::Region{{frame.look, frame.up, frame.right}, {outline_mm}}}};
}

voxel::Expression Slab::expression() const {
  return voxel::Expression(sides()) & voxel::Expression(voxel::HalfSpace{frame.look, high_mm}) &
         voxel::Expression(voxel::HalfSpace{-frame.look, -low_mm});
}

double Slab::far_end_mm(const glm::dvec3& direction) const {
  double far_mm = -std::numeric_limits<double>::infinity();
  for (const glm::dvec2& p_mm : outline_mm)
    for (const double height_mm : {low_mm, high_mm})
      far_mm = std::max(
          far_mm, glm::dot(direction, p_mm.x * frame.right + p_mm.y * frame.up + height_mm * frame.look));
  return far_mm;
}

}  // namespace octotomy::planner
