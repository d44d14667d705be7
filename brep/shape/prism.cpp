// SPDX-License-Identifier: AGPL-3.0-or-later
// Caps are constrained Delaunay triangulations without new points. Walls are built on the edges between
// inside and outside by the even-odd rule, so the polygons' winding has no effect.
#include "brep/shape/prism.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/hilbert_sort.h>
#include <CGAL/property_map.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

#include "brep/mesh/error.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
constexpr int unseen = -1;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
/// A face's info is the number of polygon edges between it and infinity.
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel,
                                                CGAL::Triangulation_face_base_with_info_2<int, Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                               CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;

struct Side {
  Kernel::Point_2 from, to;
  std::size_t polygon = 0, index = 0, side_count = 0;
  double low_u() const { return std::min(from.x(), to.x()); }
  double high_u() const { return std::max(from.x(), to.x()); }
  double low_v() const { return std::min(from.y(), to.y()); }
  double high_v() const { return std::max(from.y(), to.y()); }
};

std::string name_of(std::size_t polygon) {
  return "polygon " + std::to_string(polygon);
}

/// Tolerance of the frame's dot products. Its vectors come from closed forms or trigonometry, both accurate
/// to a few units of the last place, and a shear by this tolerance is far below a micron per metre.
constexpr double frame_tolerance() {
  return 1e-9;
}

void check_frame(const Prism& prism) {
  const auto off = [](double value, double wanted) {
    return !(std::abs(value - wanted) <= frame_tolerance());
  };
  const glm::dvec3 right = glm::cross(prism.look, prism.up);
  if (off(glm::length(prism.look), 1) || off(glm::length(prism.up), 1) || off(glm::length(right), 1) ||
      off(glm::distance(right, prism.right), 0))
    throw std::invalid_argument(
        "a prism's look, up and right must be orthonormal with right = look x up: make them so first");
  if (!std::isfinite(prism.from_mm) || !std::isfinite(prism.to_mm) || !(prism.from_mm < prism.to_mm))
    throw InvalidInput("a prism reaches from " + std::to_string(prism.from_mm) + " to " +
                       std::to_string(prism.to_mm) +
                       " mm; both depths must be finite, and the second larger");
  if (prism.polygons_mm.empty()) throw InvalidInput("a prism needs at least one polygon");
}

/// A polygon's points without those that repeat the previous one.
std::vector<glm::dvec2> distinct_points(const std::vector<glm::dvec2>& polygon, std::size_t number) {
  std::vector<glm::dvec2> points;
  for (const glm::dvec2& p : polygon) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y))
      throw InvalidInput(name_of(number) + " has a point that is not finite");
    if (points.empty() || points.back() != p) points.push_back(p);
  }
  while (points.size() > 1 && points.back() == points.front()) points.pop_back();
  if (points.size() < 3) throw InvalidInput(name_of(number) + " has fewer than three distinct points");
  return points;
}

bool follows(const Side& a, const Side& b) {
  assert(a.index < a.side_count && b.index < b.side_count);
  return a.polygon == b.polygon && (a.index + 1) % a.side_count == b.index;
}

/// Whether two sides meet other than at the end of one and the start of the next.
bool collide(const Side& a, const Side& b) {
  if (follows(b, a) && !follows(a, b)) return collide(b, a);
  if (!follows(a, b))
    return CGAL::do_intersect(Kernel::Segment_2(a.from, a.to), Kernel::Segment_2(b.from, b.to));
  // The edges share a.to, so they overlap only if b turns back along a.
  return CGAL::collinear(a.from, a.to, b.to) &&
         !CGAL::collinear_are_strictly_ordered_along_line(a.from, a.to, b.to);
}

/// Refuses sides that meet, found by a sweep along u. Cost: the number of pairs of sides whose ranges of u
/// overlap.
void check_crossings(std::vector<Side> sides) {
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::make_tuple(a.low_u(), a.polygon, a.index) < std::make_tuple(b.low_u(), b.polygon, b.index);
  });
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = i + 1; j < sides.size() && sides[j].low_u() <= sides[i].high_u(); ++j) {
      if (sides[j].low_v() > sides[i].high_v() || sides[i].low_v() > sides[j].high_v()) continue;
      if (!collide(sides[i], sides[j])) continue;
      const Side &a = sides[i], &b = sides[j];
      throw InvalidInput(name_of(a.polygon) +
                         (a.polygon == b.polygon ? " crosses or touches itself"
                                                 : " crosses or touches " + name_of(b.polygon)) +
                         ": side " + std::to_string(a.index) + " from (" + std::to_string(a.from.x()) + ", " +
                         std::to_string(a.from.y()) + ") mm meets side " + std::to_string(b.index) +
                         " from (" + std::to_string(b.from.x()) + ", " + std::to_string(b.from.y()) +
                         ") mm; draw them apart");
    }
}

/// With fewer points than this, any order is fast. They are inserted in the outline's order, which determines
/// the diagonals.
constexpr std::size_t many_points = 2000;

/// Along the outline or, for many points, along a Hilbert curve: in the order of a fine outline, each point
/// would change a large fan of triangles around the points before it.
std::vector<std::size_t> order_of_insertion(const std::vector<glm::dvec2>& points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (points.size() < many_points) return order;
  std::vector<Kernel::Point_2> places;
  places.reserve(points.size());
  for (const glm::dvec2& p : points) places.emplace_back(p.x, p.y);
  const auto place_of = CGAL::make_property_map(places);
  CGAL::hilbert_sort(order.begin(), order.end(),
                     CGAL::Spatial_sort_traits_adapter_2<Kernel, decltype(place_of)>(place_of));
  return order;
}

/// Counts, for every face, the polygon edges between it and infinity, by one flood per nesting level.
void count_nesting(Triangulation& triangulation) {
  for (auto face : triangulation.all_face_handles()) face->info() = unseen;
  std::deque<std::pair<Triangulation::Face_handle, int>> borders{{triangulation.infinite_face(), 0}};
  while (!borders.empty()) {
    const auto [start, level] = borders.front();
    assert(level >= 0);
    borders.pop_front();
    if (start->info() != unseen) continue;
    start->info() = level;
    std::vector<Triangulation::Face_handle> flood{start};
    while (!flood.empty()) {
      const auto face = flood.back();
      flood.pop_back();
      for (int i = 0; i < 3; ++i) {
        const auto beyond = face->neighbor(i);
        if (beyond->info() != unseen) continue;
        if (face->is_constrained(i)) {
          borders.emplace_back(beyond, level + 1);
        } else {
          beyond->info() = level;
          flood.push_back(beyond);
        }
      }
    }
  }
}

}  // namespace

Solid solid_of(const Prism& prism) {
  check_frame(prism);

  // Collect points and sides; refuse invalid polygons.
  std::vector<std::vector<glm::dvec2>> polygons;
  std::vector<Side> sides;
  for (std::size_t n = 0; n < prism.polygons_mm.size(); ++n) {
    polygons.push_back(distinct_points(prism.polygons_mm[n], n));
    const auto& points = polygons.back();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const glm::dvec2 &p = points[i], &q = points[(i + 1) % points.size()];
      sides.push_back({{p.x, p.y}, {q.x, q.y}, n, i, points.size()});
    }
  }
  check_crossings(sides);

  Triangulation triangulation;
  std::vector<glm::dvec2> uv;
  for (const auto& points : polygons) {
    Triangulation::Face_handle near;
    std::vector<Triangulation::Vertex_handle> ring(points.size());
    for (const std::size_t i : order_of_insertion(points)) {
      ring[i] = triangulation.insert({points[i].x, points[i].y}, near);
      ring[i]->info() = static_cast<std::uint32_t>(uv.size() + i);
      if (points.size() >= many_points) near = ring[i]->face();
    }
    uv.insert(uv.end(), points.begin(), points.end());
    for (std::size_t i = 0; i < ring.size(); ++i)
      triangulation.insert_constraint(ring[i], ring[(i + 1) % ring.size()]);
  }
  count_nesting(triangulation);

  // A polygon's triangles wind counter-clockwise in (right, up), whose normal is -look: they face out of the
  // near cap and, reversed, out of the far one.
  Triangles triangles;
  const auto count = static_cast<std::uint32_t>(uv.size());
  for (const double depth : {prism.from_mm, prism.to_mm})
    for (const glm::dvec2& p : uv)
      triangles.points_mm.push_back(prism.right * p.x + prism.up * p.y + prism.look * depth);
  for (auto face : triangulation.finite_face_handles()) {
    if (face->info() % 2 == 0) continue;
    const std::array<std::uint32_t, 3> v{face->vertex(0)->info(), face->vertex(1)->info(),
                                         face->vertex(2)->info()};
    assert(std::max({v[0], v[1], v[2]}) < count);
    triangles.faces.push_back({v[0], v[1], v[2]});
    triangles.faces.push_back({v[0] + count, v[2] + count, v[1] + count});
    for (int i = 0; i < 3; ++i) {
      if (face->neighbor(i)->info() % 2 != 0) continue;
      const std::uint32_t a = v[(i + 1) % 3], b = v[(i + 2) % 3];
      triangles.faces.push_back({b, a, a + count});
      triangles.faces.push_back({b, a + count, b + count});
    }
  }
  return trusted_solid(std::move(triangles), Proof::Construction);
}

}  // namespace octotomy::brep
