// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 surfaces that meet have no gap; 2 of those that do not, the nearest points are a corner of one and a
// point of a triangle of the other, or lie on an edge of each: the nearest corner bounds what edges need be
// tried.
#include "brep/measure/gap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "brep/mesh/distance.h"
#include "brep/mesh/intersecting_triangles.h"
#include "brep/mesh/mesh_point.h"
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
  // Where they are parallel any point of s will do.
  double on_s = share(st * tr - sr * tt, ss * tt - st * st);
  const double on_t = share(st * on_s + tr, tt);
  on_s = share(st * on_t - sr, ss);
  const glm::dvec3 p = s.from + on_s * along_s, q = t.from + on_t * along_t;
  return {glm::distance(p, q), p, q};
}

std::vector<Segment> edges_of(const Mesh& mesh) {
  std::vector<Segment> edges;
  const auto at = [&](Mesh::VertexHandle v) { return glm_of(mesh.point(v)); };
  for (const auto e : mesh.edges()) {
    const Mesh::HalfedgeHandle h = mesh.halfedge_handle(e, 0);
    edges.push_back({at(mesh.from_vertex_handle(h)), at(mesh.to_vertex_handle(h))});
  }
  return edges;
}

using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

std::vector<Box> boxes_of(const std::vector<Segment>& edges, double margin_mm) {
  std::vector<Box> boxes;
  boxes.reserve(edges.size());
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    const glm::dvec3 low = glm::min(edges[i].from, edges[i].to) - margin_mm,
                     high = glm::max(edges[i].from, edges[i].to) + margin_mm;
    boxes.emplace_back(CGAL::Bbox_3(low.x, low.y, low.z, high.x, high.y, high.z), i);
  }
  return boxes;
}

/// The nearest corner of one surface to the other.
Gap corner_gap(const Triangles& corners, const Triangles& surface) {
  std::vector<glm::dvec3> points;
  for (const auto& face : corners.faces)
    for (const std::uint32_t v : face) points.push_back(corners.points_mm[v]);
  const std::vector<Foot> feet = SurfaceTree(surface).feet(points);
  assert(!feet.empty());
  const auto nearest = std::min_element(
      feet.begin(), feet.end(), [](const Foot& f, const Foot& g) { return f.distance_mm < g.distance_mm; });
  return {nearest->distance_mm, points[static_cast<std::size_t>(nearest - feet.begin())], nearest->p_mm};
}

Kernel::Triangle_3 triangle_of(const Triangles& surface, std::uint32_t face) {
  const auto point = [&](std::size_t k) {
    const glm::dvec3& p = surface.points_mm[surface.faces[face][k]];
    return Kernel::Point_3(p.x, p.y, p.z);
  };
  return {point(0), point(1), point(2)};
}

/// A point of what two triangles have in common.
struct AnyPoint {
  using result_type = Kernel::Point_3;
  Kernel::Point_3 operator()(const Kernel::Point_3& p) const { return p; }
  Kernel::Point_3 operator()(const Kernel::Segment_3& s) const { return s.source(); }
  Kernel::Point_3 operator()(const Kernel::Triangle_3& t) const { return t.vertex(0); }
  Kernel::Point_3 operator()(const std::vector<Kernel::Point_3>& polygon) const { return polygon.front(); }
};

/// A point that two surfaces have in common, to rounding.
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
  // Only triangles without area meet: a corner of one stands for it.
  return a.points_mm[a.faces[meeting.of_a.front()][0]];
}

}  // namespace

Gap gap(const Mesh& a, const Mesh& b) {
  if (a.n_faces() == 0 || b.n_faces() == 0)
    throw std::invalid_argument("gap: there is no distance to a surface without triangles");
  const Triangles of_a = triangles_of(a), of_b = triangles_of(b);
  const IntersectingTriangles meeting = intersecting_triangles(of_a, of_b);
  if (!meeting.of_a.empty()) {
    const glm::dvec3 p = common_point(of_a, of_b, meeting);
    return {0.0, p, p};
  }
  Gap best = corner_gap(of_a, of_b);
  const Gap other = corner_gap(of_b, of_a);
  if (other.distance_mm < best.distance_mm) best = {other.distance_mm, other.on_b_mm, other.on_a_mm};

  const std::vector<Segment> edges_a = edges_of(a), edges_b = edges_of(b);
  std::vector<Box> boxes_a = boxes_of(edges_a, best.distance_mm), boxes_b = boxes_of(edges_b, 0.0);
  // Pairs come in any order: of equal ones the first by number stands.
  bool found = false;
  std::pair<std::uint32_t, std::uint32_t> first;
  CGAL::box_intersection_d(boxes_a.begin(), boxes_a.end(), boxes_b.begin(), boxes_b.end(),
                           [&](const Box& s, const Box& t) {
                             assert(s.info() < edges_a.size() && t.info() < edges_b.size());
                             const Gap between = gap_of(edges_a[s.info()], edges_b[t.info()]);
                             const std::pair pair(s.info(), t.info());
                             if (between.distance_mm > best.distance_mm) return;
                             if (between.distance_mm == best.distance_mm && (!found || first < pair)) return;
                             best = between;
                             first = pair;
                             found = true;
                           });
  return best;
}

}  // namespace octotomy::brep
