// SPDX-License-Identifier: AGPL-3.0-or-later
// Surfaces that intersect have no gap. Otherwise two trees find the nearest triangles. Their nearest points
// are a corner of one and a point of the other, or lie on an edge of each.
#include "brep/measure/gap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/intersecting_triangles.h"
#include "brep/mesh/morton_tree.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct Segment {
  glm::dvec3 from, to;
};

/// Nearest points of two segments (Ericson, Real-Time Collision Detection, 2005, 5.1.9).
Gap gap_of(const Segment& s, const Segment& t) {
  const glm::dvec3 along_s = s.to - s.from, along_t = t.to - t.from, apart = s.from - t.from;
  const double ss = glm::dot(along_s, along_s), tt = glm::dot(along_t, along_t),
               st = glm::dot(along_s, along_t), sr = glm::dot(along_s, apart), tr = glm::dot(along_t, apart);
  const auto share = [](double part, double whole) {
    return whole > 0.0 ? std::clamp(part / whole, 0.0, 1.0) : 0.0;
  };
  // If the segments are parallel, any point of s is valid.
  double on_s = share(st * tr - sr * tt, ss * tt - st * st);
  const double on_t = share(st * on_s + tr, tt);
  on_s = share(st * on_t - sr, ss);
  const glm::dvec3 p = s.from + on_s * along_s, q = t.from + on_t * along_t;
  return {glm::distance(p, q), p, q};
}

std::array<glm::dvec3, 3> corners_of(const Triangles& surface, std::uint32_t face) {
  const auto& f = surface.faces[face];
  return {surface.points_mm[f[0]], surface.points_mm[f[1]], surface.points_mm[f[2]]};
}

/// The distance of a triangle from another one's plane, if it lies wholly on one side: a lower bound of the
/// triangles' distance.
double beyond_plane(const std::array<glm::dvec3, 3>& s, const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 normal = glm::cross(s[1] - s[0], s[2] - s[0]);
  const double length = glm::length(normal);
  if (!(length > 0.0)) return 0.0;
  const auto [low, high] = std::minmax(
      {glm::dot(t[0] - s[0], normal), glm::dot(t[1] - s[0], normal), glm::dot(t[2] - s[0], normal)});
  return std::max(std::max(low, -high) / length, 0.0);
}

/// Nearest points of two triangles that do not intersect: a corner of one and a point of the other, or a
/// point of an edge of each.
Gap gap_of(const std::array<glm::dvec3, 3>& s, const std::array<glm::dvec3, 3>& t) {
  Gap best{std::numeric_limits<double>::infinity()};
  const auto take = [&](const Gap& one) {
    if (one.distance_mm < best.distance_mm) best = one;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 on_t = nearest_of_triangle(s[k], t[0], t[1], t[2]),
                     on_s = nearest_of_triangle(t[k], s[0], s[1], s[2]);
    take({glm::distance(s[k], on_t), s[k], on_t});
    take({glm::distance(on_s, t[k]), on_s, t[k]});
  }
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t m = 0; m < 3; ++m)
      take(gap_of(Segment{s[k], s[(k + 1) % 3]}, Segment{t[m], t[(m + 1) % 3]}));
  return best;
}

Kernel::Triangle_3 triangle_of(const Triangles& surface, std::uint32_t face) {
  const auto point = [&](std::size_t k) {
    const glm::dvec3& p = surface.points_mm[surface.faces[face][k]];
    return Kernel::Point_3(p.x, p.y, p.z);
  };
  return {point(0), point(1), point(2)};
}

/// A point of the intersection of two triangles.
struct AnyPoint {
  using result_type = Kernel::Point_3;
  Kernel::Point_3 operator()(const Kernel::Point_3& p) const { return p; }
  Kernel::Point_3 operator()(const Kernel::Segment_3& s) const { return s.source(); }
  Kernel::Point_3 operator()(const Kernel::Triangle_3& t) const { return t.vertex(0); }
  Kernel::Point_3 operator()(const std::vector<Kernel::Point_3>& polygon) const { return polygon.front(); }
};

/// A common point of two surfaces, up to rounding.
glm::dvec3 common_point(const Triangles& a, const Triangles& b, const IntersectingTriangles& meeting) {
  for (const std::uint32_t f : meeting.of_a)
    for (const std::uint32_t g : meeting.of_b) {
      const Kernel::Triangle_3 s = triangle_of(a, f), t = triangle_of(b, g);
      if (s.is_degenerate() || t.is_degenerate() || !CGAL::do_intersect(s, t)) continue;
      if (const auto common = CGAL::intersection(s, t)) {
        const Kernel::Point_3 p = boost::apply_visitor(AnyPoint(), *common);
        return {p.x(), p.y(), p.z()};
      }
    }
  assert(!meeting.of_a.empty());
  // Only triangles without area intersect: returns a corner of one.
  return a.points_mm[a.faces[meeting.of_a.front()][0]];
}

}  // namespace

Gap gap(const Triangles& a, const Triangles& b) {
  if (a.faces.empty() || b.faces.empty())
    throw InvalidInput("gap: there is no distance to a surface without triangles");
  const IntersectingTriangles meeting = intersecting_triangles(a, b);
  if (!meeting.of_a.empty()) {
    const glm::dvec3 p = common_point(a, b, meeting);
    return {0.0, p, p};
  }
  Gap best{std::numeric_limits<double>::infinity()};
  MortonTree(a).visit_near_pairs(
      MortonTree(b), [&] { return best.distance_mm * best.distance_mm; },
      [&](std::uint32_t f, std::uint32_t g) {
        const auto s = corners_of(a, f), t = corners_of(b, g);
        // Where surfaces are nearly parallel, the test by planes excludes most pairs at a tenth of the cost.
        constexpr double rounding_mm = 1e-9;
        if (std::max(beyond_plane(s, t), beyond_plane(t, s)) > best.distance_mm + rounding_mm) return;
        if (const Gap between = gap_of(s, t); between.distance_mm < best.distance_mm) best = between;
      });
  return best;
}

}  // namespace octotomy::brep
