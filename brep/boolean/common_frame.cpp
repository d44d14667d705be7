// SPDX-License-Identifier: AGPL-3.0-or-later
// The corners of a rotated box lie off the planes of its faces by last places. Flush faces of two such boxes then
// cross at angles of rounding, and the space between them is thinner than the rounding of points, so results
// intersect themselves. No rounding of the points makes the faces coplanar in that pose.
// 1 find pairs of triangles of both solids that lie on one plane; 2 choose the direction with the largest common
// area, and one square to it: another common direction, or else that of the largest triangle; 3 turn the solids so
// that these are axes; 4 put points that lie beside a plane square to an axis by rounding onto it.
#include "brep/boolean/common_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "brep/boolean/coplanar_pairs.h"
#include "brep/mesh/coordinate_order.h"
#include "brep/mesh/flat_triangles.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t most_triangles = 200'000;

/// How far points of one plane may lie off it, in units of rounding. A rotation sums three products, and a
/// file rounds once more. Three points rounded in this way define a plane that may be off by the same length
/// between the points.
constexpr double beside_plane() {
  return 8.0;
}

/// Coordinates that differ by less than this many units of rounding become equal: twice beside_plane(), plus
/// the error of the rotation into the frame.
constexpr double apart_along_axis() {
  return 32.0;
}

/// A direction to which planes of both solids are perpendicular.
struct Direction {
  glm::dvec3 normal{0.0};
  double area_mm2 = 0.0;
};

bool is_axis(const glm::dvec3& normal) {
  return (normal.x != 0.0) + (normal.y != 0.0) + (normal.z != 0.0) == 1;
}

/// Directions of the common planes, in the order in which they are found. Each is the normal of the largest
/// triangle on these planes. Cost: n log n, and the pairs of triangles whose planes lie equally far from the
/// origin.
std::vector<Direction> common_directions(const std::vector<Plane>& of_a, const std::vector<Plane>& of_b,
                                         double tolerance_mm) {
  std::vector<Direction> directions;
  std::vector<double> widest_mm2;
  for_each_coplanar_pair(of_a, of_b, tolerance_mm, [&](const Plane& a, const Plane& b) {
    const bool is_a_wider = a.area_mm2 >= b.area_mm2;
    const Plane &wide = is_a_wider ? a : b, &narrow = is_a_wider ? b : a;
    auto known = std::find_if(directions.begin(), directions.end(), [&](const Direction& d) {
      return glm::length(glm::cross(d.normal, wide.normal)) <= same_direction();
    });
    if (known == directions.end()) {
      directions.push_back({wide.normal, 0.0});
      widest_mm2.push_back(0.0);
      known = directions.end() - 1;
    }
    known->area_mm2 += narrow.area_mm2;
    double& widest = widest_mm2[static_cast<std::size_t>(known - directions.begin())];
    if (wide.area_mm2 > widest) {
      widest = wide.area_mm2;
      known->normal = wide.normal;
    }
  });
  return directions;
}

/// Among the directions for which `may_be` returns true, the one of largest area; of equal ones, the first.
template <typename MayBe>
std::optional<glm::dvec3> widest_direction(const std::vector<Direction>& directions, const MayBe& may_be) {
  const Direction* best = nullptr;
  for (const Direction& d : directions)
    if (may_be(d.normal) && (best == nullptr || d.area_mm2 > best->area_mm2)) best = &d;
  return best == nullptr ? std::nullopt : std::optional(best->normal);
}

/// The normal of the largest triangle for whose normal `may_be` returns true.
template <typename MayBe>
std::optional<glm::dvec3> widest_plane(const std::vector<Plane>& of_a, const std::vector<Plane>& of_b,
                                       const MayBe& may_be) {
  const Plane* best = nullptr;
  for (const std::vector<Plane>* planes : {&of_a, &of_b})
    for (const Plane& plane : *planes)
      if (may_be(plane.normal) && (best == nullptr || plane.area_mm2 > best->area_mm2)) best = &plane;
  return best == nullptr ? std::nullopt : std::optional(best->normal);
}

/// The positions, along an axis of the frame, of the planes that are square to this axis: ascending, farther
/// apart than the tolerance.
std::vector<double> offsets_along(const std::vector<Plane>& of_a, const std::vector<Plane>& of_b,
                                  const glm::dvec3& axis, const glm::dvec3& origin_mm, double tolerance_mm) {
  std::vector<double> all, apart;
  for (const std::vector<Plane>* planes : {&of_a, &of_b})
    for (const Plane& plane : *planes)
      if (glm::length(glm::cross(plane.normal, axis)) <= same_direction())
        all.push_back(glm::dot(plane.on_mm - origin_mm, axis));
  std::sort(all.begin(), all.end());
  for (const double offset : all)
    if (apart.empty() || offset - apart.back() > tolerance_mm) apart.push_back(offset);
  return apart;
}

/// The offset within the tolerance of a coordinate; the coordinate itself if there is none.
double on_plane(double coordinate, const std::vector<double>& offsets, double tolerance_mm) {
  auto above = std::lower_bound(offsets.begin(), offsets.end(), coordinate);
  if (above != offsets.end() && *above - coordinate <= tolerance_mm) return *above;
  if (above != offsets.begin() && coordinate - *(above - 1) <= tolerance_mm) return *(above - 1);
  return coordinate;
}

/// Whether all points that differ in `given` also differ in `turned`.
bool are_apart(const std::vector<glm::dvec3>& given, const std::vector<glm::dvec3>& turned) {
  std::map<CommonFrame::PointKey, glm::dvec3> at;
  for (std::size_t i = 0; i < turned.size(); ++i) {
    const auto [known, is_new] = at.try_emplace({turned[i].x, turned[i].y, turned[i].z}, given[i]);
    if (!is_new && known->second != given[i]) return false;
  }
  return true;
}

}  // namespace

Triangles CommonFrame::moved_back(const Triangles& triangles) const {
  Triangles back = triangles;
  std::vector<std::uint8_t> is_given(back.points_mm.size(), 0);
  for (std::size_t v = 0; v < back.points_mm.size(); ++v) {
    glm::dvec3& p = back.points_mm[v];
    const auto given = given_mm.find({p.x, p.y, p.z});
    is_given[v] = given != given_mm.end();
    p = is_given[v] ? given->second : origin_mm + lps_from_frame * p;
  }
  // Merges new points that coincide except for rounding, because the triangles between them are reversed.
  for (const auto& face : back.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t v = face[k], w = face[(k + 1) % 3];
      if (is_given[v] < is_given[w] || (is_given[v] == is_given[w] && w < v)) std::swap(v, w);
      if (!is_given[w] && glm::distance(back.points_mm[v], back.points_mm[w]) <= kept_mm)
        back.points_mm[w] = back.points_mm[v];
    }
  if (!has_flat_triangles(back)) return back;
  Mesh mesh = mesh_of(back);
  take_out_flat_triangles(mesh);
  return in_coordinate_order(mesh);
}

std::optional<CommonFrame> common_frame(const Solid& a, const Solid& b) {
  if (a.empty() || b.empty()) return std::nullopt;
  const Triangles &of_a = a.triangles(), &of_b = b.triangles();
  const PointRounding rounding = point_rounding(of_a, of_b);
  const double unit_mm = rounding.mm;
  const double margin_mm = beside_plane() * unit_mm;
  const glm::dvec3 low = glm::max(a.size().low_mm, b.size().low_mm) - margin_mm;
  const glm::dvec3 high = glm::min(a.size().high_mm, b.size().high_mm) + margin_mm;
  if (glm::any(glm::greaterThan(low, high))) return std::nullopt;
  const std::vector<Plane> planes_a = planes_of(of_a, low, high), planes_b = planes_of(of_b, low, high);
  if (planes_a.size() + planes_b.size() > most_triangles) return std::nullopt;
  const std::vector<Direction> directions = common_directions(planes_a, planes_b, margin_mm);
  const std::optional<glm::dvec3> first =
      widest_direction(directions, [](const glm::dvec3& n) { return !is_axis(n); });
  if (!first) return std::nullopt;
  const auto is_square = [&](const glm::dvec3& n) {
    return std::abs(glm::dot(n, *first)) <= same_direction();
  };
  std::optional<glm::dvec3> square = widest_direction(directions, is_square);
  if (!square) square = widest_plane(planes_a, planes_b, is_square);
  glm::dvec3 second = square.value_or(std::abs(first->x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0));
  second = glm::normalize(second - glm::dot(second, *first) * *first);

  CommonFrame frame;
  frame.lps_from_frame = glm::dmat3(glm::cross(second, *first), second, *first);
  frame.origin_mm = 0.5 * (low + high);
  const glm::dmat3 frame_from_lps = glm::transpose(frame.lps_from_frame);
  Triangles turned_a = of_a, turned_b = of_b;
  for (Triangles* turned : {&turned_a, &turned_b})
    for (glm::dvec3& p : turned->points_mm) p = frame_from_lps * (p - frame.origin_mm);
  const Triangles exact_a = turned_a, exact_b = turned_b;
  const double tolerance_mm = frame.tolerance_mm = apart_along_axis() * unit_mm;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> offsets =
        offsets_along(planes_a, planes_b, frame.lps_from_frame[axis], frame.origin_mm, tolerance_mm);
    for (Triangles* turned : {&turned_a, &turned_b})
      for (glm::dvec3& p : turned->points_mm) p[axis] = on_plane(p[axis], offsets, tolerance_mm);
  }
  if (!are_apart(of_a.points_mm, turned_a.points_mm) || !are_apart(of_b.points_mm, turned_b.points_mm))
    return std::nullopt;
  // Only points that were moved by no more than the last places of doubles get their given coordinates back.
  // Moving other points back could reverse the triangles that were cut beside them.
  frame.kept_mm = apart_along_axis() * std::numeric_limits<double>::epsilon() * rounding.reach_mm;
  const auto keep = [&](const Triangles& given, const Triangles& exact, const Triangles& turned) {
    for (std::size_t i = 0; i < turned.points_mm.size(); ++i) {
      const glm::dvec3& p = turned.points_mm[i];
      const glm::dvec3 back_mm = frame.origin_mm + frame.lps_from_frame * p;
      if (glm::distance(back_mm, given.points_mm[i]) <= frame.kept_mm)
        frame.given_mm.try_emplace({p.x, p.y, p.z}, given.points_mm[i]);
      frame.moved_mm = std::max(frame.moved_mm, glm::distance(p, exact.points_mm[i]));
    }
  };
  keep(of_a, exact_a, turned_a);
  keep(of_b, exact_b, turned_b);
  frame.a = trusted_solid(std::move(turned_a), Proof::Rounded);
  frame.b = trusted_solid(std::move(turned_b), Proof::Rounded);
  return frame;
}

}  // namespace octotomy::brep
