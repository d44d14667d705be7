// SPDX-License-Identifier: AGPL-3.0-or-later
// Points made by a cut are rounded. The triangles of a piece therefore deviate by last places from the bone's
// triangles that they were cut from, and the two surfaces cross there many times.
// 1 find pairs of triangles on one plane; 2 merge points of both that differ only by rounding; 3 list the points of
// either that lie in the other's triangles or on their sides, and where sides cross; 4 divide the first solid's
// triangles by these points and by the other's sides; 5 divide the second solid's triangles by the sides that the
// first solid then has.
#include "brep/boolean/imprint.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "brep/boolean/coplanar_pairs.h"
#include "brep/mesh/coordinate_order.h"
#include "brep/mesh/split_fans.h"

namespace octotomy::brep {
namespace {

using PlaneKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PlaneLinks = CGAL::Triangulation_data_structure_2<
    CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, PlaneKernel>,
    CGAL::Constrained_triangulation_face_base_2<PlaneKernel>>;
using PlaneTriangulation =
    CGAL::Constrained_Delaunay_triangulation_2<PlaneKernel, PlaneLinks,
                                               CGAL::No_constraint_intersection_requiring_constructions_tag>;

constexpr std::size_t most_imprinted = 200'000;

using FacePoints = std::array<std::uint32_t, 3>;
using SidePoints = std::pair<std::uint32_t, std::uint32_t>;  // the lower point first

SidePoints side_points(std::uint32_t v, std::uint32_t w) {
  return {std::min(v, w), std::max(v, w)};
}

/// Thrown if rounding left sides that cross, so that a triangle cannot be divided.
struct NotDivided : std::exception {};

class Imprint {
 public:
  Imprint(const Solid& a, const Solid& b) {
    std::map<std::array<double, 3>, std::uint32_t> known;
    for (std::size_t k = 0; k < 2; ++k) {
      const Triangles& given = k == 0 ? a.triangles() : b.triangles();
      std::vector<std::uint32_t> numbers;
      for (const glm::dvec3& p : given.points_mm) {
        const auto [at, is_new] =
            known.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(points_mm_.size()));
        if (is_new) points_mm_.push_back(p);
        numbers.push_back(at->second);
      }
      for (const auto& face : given.faces)
        faces_[k].push_back({numbers[face[0]], numbers[face[1]], numbers[face[2]]});
      inner_[k].resize(given.faces.size());
      partners_[k].resize(given.faces.size());
    }
  }

  /// Whether any triangles of both solids meet on one plane.
  bool find_pairs(const std::vector<Plane>& of_a, const std::vector<Plane>& of_b, double tolerance_mm) {
    tolerance_mm_ = tolerance_mm;
    for_each_coplanar_pair(of_a, of_b, tolerance_mm, [&](const Plane& a, const Plane& b) {
      for (int k = 0; k < 3; ++k) {
        const auto [low_a, high_a] =
            std::minmax({a.corners_mm[0][k], a.corners_mm[1][k], a.corners_mm[2][k]});
        const auto [low_b, high_b] =
            std::minmax({b.corners_mm[0][k], b.corners_mm[1][k], b.corners_mm[2][k]});
        if (low_a > high_b + tolerance_mm || low_b > high_a + tolerance_mm) return;
      }
      pairs_.emplace_back(a.face, b.face);
    });
    merge_points();
    for (const auto& [f, g] : pairs_) {
      place_corners(0, f, faces_[1][g]);
      place_corners(1, g, faces_[0][f]);
      partners_[0][f].push_back(g);
      partners_[1][g].push_back(f);
    }
    for (const auto& [f, g] : pairs_)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) cross_sides(f, i, g, j);
    return !pairs_.empty();
  }

  /// Divides both surfaces and returns them. Throws NotDivided.
  std::array<Triangles, 2> divided() {
    std::array<Triangles, 2> surfaces;
    std::vector<std::vector<FacePoints>> parts_of_a(faces_[0].size());
    for (std::size_t k = 0; k < 2; ++k) {
      surfaces[k].points_mm = points_mm_;
      for (std::uint32_t f = 0; f < faces_[k].size(); ++f) {
        std::vector<FacePoints> parts = k == 0 ? parts_of_first(f) : parts_of_second(f, parts_of_a);
        surfaces[k].faces.insert(surfaces[k].faces.end(), parts.begin(), parts.end());
        if (k == 0) parts_of_a[f] = std::move(parts);
      }
    }
    return surfaces;
  }

  double moved_mm() const { return moved_mm_; }

 private:
  void merge_points() {
    std::vector<std::uint32_t> same(points_mm_.size());
    for (std::uint32_t v = 0; v < same.size(); ++v) same[v] = v;
    for (const auto& [f, g] : pairs_)
      for (const std::uint32_t v : faces_[0][f])
        for (const std::uint32_t w : faces_[1][g]) {
          const double apart_mm = glm::distance(points_mm_[v], points_mm_[w]);
          if (v == w || same[w] != w || same[v] != v || apart_mm > tolerance_mm_) continue;
          same[w] = v;
          moved_mm_ = std::max(moved_mm_, apart_mm);
        }
    for (FacePoints& face : faces_[1])
      for (std::uint32_t& v : face) v = same[v];
  }

  glm::dvec3 normal_of(const FacePoints& face) const {
    const glm::dvec3& p = points_mm_[face[0]];
    return glm::normalize(glm::cross(points_mm_[face[1]] - p, points_mm_[face[2]] - p));
  }

  /// The distance of a point from a side, positive inward.
  double inward_mm(const FacePoints& face, std::size_t side, const glm::dvec3& normal,
                   const glm::dvec3& p) const {
    const glm::dvec3 &from = points_mm_[face[side]], &to = points_mm_[face[(side + 1) % 3]];
    return glm::dot(glm::cross(normal, glm::normalize(to - from)), p - from);
  }

  /// Records which corners of another triangle lie in a triangle, and which lie on its sides.
  void place_corners(std::size_t solid, std::uint32_t f, const FacePoints& others) {
    const FacePoints& face = faces_[solid][f];
    const glm::dvec3 normal = normal_of(face);
    for (const std::uint32_t v : others) {
      if (std::find(face.begin(), face.end(), v) != face.end()) continue;
      const glm::dvec3& p = points_mm_[v];
      std::array<double, 3> inward{};
      for (std::size_t k = 0; k < 3; ++k) inward[k] = inward_mm(face, k, normal, p);
      const auto nearest =
          static_cast<std::size_t>(std::min_element(inward.begin(), inward.end()) - inward.begin());
      if (inward[nearest] < -tolerance_mm_) continue;
      if (inward[nearest] <= tolerance_mm_) {
        on_side_[solid][side_points(face[nearest], face[(nearest + 1) % 3])].insert(v);
        moved_mm_ = std::max(moved_mm_, std::abs(inward[nearest]));
      } else {
        inner_[solid][f].insert(v);
      }
      moved_mm_ = std::max(moved_mm_, std::abs(glm::dot(normal, p - points_mm_[face[0]])));
    }
  }

  bool is_on(std::size_t solid, const SidePoints& side, std::uint32_t v) const {
    const auto found = on_side_[solid].find(side);
    return v == side.first || v == side.second ||
           (found != on_side_[solid].end() && found->second.count(v) != 0);
  }

  /// If a side of the first solid crosses a side of the second, adds the crossing point to both sides.
  void cross_sides(std::uint32_t f, std::size_t i, std::uint32_t g, std::size_t j) {
    const FacePoints &of_a = faces_[0][f], &of_b = faces_[1][g];
    const SidePoints a = side_points(of_a[i], of_a[(i + 1) % 3]), b = side_points(of_b[j], of_b[(j + 1) % 3]);
    if (is_on(0, a, b.first) || is_on(0, a, b.second) || is_on(1, b, a.first) || is_on(1, b, a.second))
      return;
    const std::array<std::uint32_t, 4> key{a.first, a.second, b.first, b.second};
    if (crossings_.count(key) != 0) return;
    const glm::dvec3 normal = normal_of(of_a);
    const glm::dvec3 &p = points_mm_[a.first], &q = points_mm_[a.second], &r = points_mm_[b.first],
                     &s = points_mm_[b.second];
    const auto beside = [&](const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& point) {
      return glm::dot(glm::cross(normal, to - from), point - from);
    };
    const double at_p = beside(r, s, p), at_q = beside(r, s, q), at_r = beside(p, q, r),
                 at_s = beside(p, q, s);
    if (!(at_p * at_q < 0.0) || !(at_r * at_s < 0.0)) return;
    const auto number = static_cast<std::uint32_t>(points_mm_.size());
    points_mm_.push_back(p + (q - p) * (at_p / (at_p - at_q)));
    crossings_.emplace(key, number);
    on_side_[0][a].insert(number);
    on_side_[1][b].insert(number);
  }

  /// The points of a side, from one end to the other.
  std::vector<std::uint32_t> chain(std::size_t solid, std::uint32_t from, std::uint32_t to) const {
    std::vector<std::uint32_t> chain{from};
    if (const auto found = on_side_[solid].find(side_points(from, to)); found != on_side_[solid].end()) {
      const glm::dvec3 start = points_mm_[from], along = points_mm_[to] - start;
      std::vector<std::pair<double, std::uint32_t>> between;
      for (const std::uint32_t v : found->second)
        between.emplace_back(glm::dot(along, points_mm_[v] - start), v);
      std::sort(between.begin(), between.end());
      for (const auto& [at, v] : between) chain.push_back(v);
    }
    chain.push_back(to);
    return chain;
  }

  /// The sides of a triangle, divided at the points on them.
  std::vector<SidePoints> border(std::size_t solid, std::uint32_t f) const {
    std::vector<SidePoints> sides;
    const FacePoints& face = faces_[solid][f];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::vector<std::uint32_t> points = chain(solid, face[k], face[(k + 1) % 3]);
      for (std::size_t i = 0; i + 1 < points.size(); ++i)
        sides.push_back(side_points(points[i], points[i + 1]));
    }
    return sides;
  }

  std::set<std::uint32_t> points_in(std::size_t solid, std::uint32_t f) const {
    std::set<std::uint32_t> points = inner_[solid][f];
    for (const SidePoints& side : border(solid, f)) points.insert({side.first, side.second});
    return points;
  }

  std::vector<FacePoints> parts_of_first(std::uint32_t f) const {
    const std::set<std::uint32_t> points = points_in(0, f);
    std::set<SidePoints> within;
    for (const std::uint32_t g : partners_[0][f])
      for (const SidePoints& side : border(1, g))
        if (points.count(side.first) != 0 && points.count(side.second) != 0) within.insert(side);
    return parts(0, f, points, within);
  }

  std::vector<FacePoints> parts_of_second(std::uint32_t g,
                                          const std::vector<std::vector<FacePoints>>& parts_of_a) const {
    const std::set<std::uint32_t> points = points_in(1, g);
    std::set<SidePoints> within;
    for (const std::uint32_t f : partners_[1][g])
      for (const FacePoints& part : parts_of_a[f])
        for (std::size_t k = 0; k < 3; ++k)
          if (const SidePoints side = side_points(part[k], part[(k + 1) % 3]);
              points.count(side.first) != 0 && points.count(side.second) != 0)
            within.insert(side);
    return parts(1, g, points, within);
  }

  /// A triangle divided at points and by sides.
  std::vector<FacePoints> parts(std::size_t solid, std::uint32_t f, const std::set<std::uint32_t>& points,
                                const std::set<SidePoints>& within) const {
    const FacePoints& face = faces_[solid][f];
    if (points.size() == 3) return {face};
    // Projects along the axis nearest to the normal: the other two coordinates stay unrounded.
    const glm::dvec3 normal = normal_of(face), size = glm::abs(normal);
    const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    int u = (drop + 1) % 3, v = (drop + 2) % 3;
    if (normal[drop] < 0.0) std::swap(u, v);
    PlaneTriangulation plane;
    std::map<std::uint32_t, PlaneTriangulation::Vertex_handle> handles;
    for (const std::uint32_t number : points) {
      const glm::dvec3& p = points_mm_[number];
      const std::size_t before = plane.number_of_vertices();
      const PlaneTriangulation::Vertex_handle handle = plane.insert(PlaneKernel::Point_2(p[u], p[v]));
      if (plane.number_of_vertices() == before) throw NotDivided();
      handle->info() = number;
      handles.emplace(number, handle);
    }
    const std::vector<SidePoints> outline = border(solid, f);
    const std::set<SidePoints> outer(outline.begin(), outline.end());
    for (const std::set<SidePoints>* sides : {&outer, &within})
      for (const SidePoints& side : *sides) {
        plane.insert_constraint(handles.at(side.first), handles.at(side.second));
        if (plane.number_of_vertices() != points.size()) throw NotDivided();
      }
    return inside(plane, outer);
  }

  /// Collects the triangles within the outline.
  static std::vector<FacePoints> inside(const PlaneTriangulation& plane,
                                        const std::set<SidePoints>& outline) {
    std::set<PlaneTriangulation::Face_handle> outside{plane.infinite_face()};
    std::vector<PlaneTriangulation::Face_handle> flood{plane.infinite_face()};
    while (!flood.empty()) {
      const PlaneTriangulation::Face_handle face = flood.back();
      flood.pop_back();
      for (int k = 0; k < 3; ++k) {
        const auto v = face->vertex(PlaneTriangulation::ccw(k)), w = face->vertex(PlaneTriangulation::cw(k));
        const bool is_finite = !plane.is_infinite(v) && !plane.is_infinite(w);
        if (is_finite && outline.count(side_points(v->info(), w->info())) != 0) continue;
        if (const PlaneTriangulation::Face_handle next = face->neighbor(k); outside.insert(next).second)
          flood.push_back(next);
      }
    }
    std::vector<FacePoints> parts;
    for (auto face = plane.finite_faces_begin(); face != plane.finite_faces_end(); ++face)
      if (outside.count(face) == 0)
        parts.push_back({face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
    return parts;
  }

  double tolerance_mm_ = 0.0, moved_mm_ = 0.0;
  std::vector<glm::dvec3> points_mm_;  ///< points of both solids, equal points once, then the points where
                                       ///< sides cross
  std::array<std::vector<FacePoints>, 2> faces_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;
  std::array<std::vector<std::vector<std::uint32_t>>, 2> partners_;
  std::array<std::map<SidePoints, std::set<std::uint32_t>>, 2> on_side_;
  std::array<std::vector<std::set<std::uint32_t>>, 2> inner_;
  std::map<std::array<std::uint32_t, 4>, std::uint32_t> crossings_;
};

/// How far a point may lie off the triangle from which it was cut, in multiples of the rounding. A motion
/// computes each coordinate as a sum of three products. Points of doubles may also have been merged by
/// settle.cpp.
constexpr double beside_triangle(bool are_floats) {
  return are_floats ? 8.0 : 64.0;
}

std::optional<Solid> solid_of_parts(const Triangles& parts) {
  const SplitFans split = split_fans(parts);
  const Linked joined = linked(split.surface);
  if (!joined.is_closed() || !split.left_out.empty()) return std::nullopt;
  return trusted_solid(in_coordinate_order(mesh_of(joined)), Proof::Rounded);
}

}  // namespace

std::optional<Imprinted> imprinted(const Solid& a, const Solid& b) {
  if (a.empty() || b.empty()) return std::nullopt;
  const PointRounding rounding = point_rounding(a.triangles(), b.triangles());
  const double tolerance_mm = beside_triangle(rounding.are_floats) * rounding.mm;
  const glm::dvec3 low = glm::max(a.size().low_mm, b.size().low_mm) - tolerance_mm;
  const glm::dvec3 high = glm::min(a.size().high_mm, b.size().high_mm) + tolerance_mm;
  const std::vector<Plane> of_a = planes_of(a.triangles(), low, high),
                           of_b = planes_of(b.triangles(), low, high);
  if (of_a.size() + of_b.size() > most_imprinted) return std::nullopt;
  try {
    Imprint imprint(a, b);
    if (!imprint.find_pairs(of_a, of_b, tolerance_mm)) return std::nullopt;
    const std::array<Triangles, 2> divided = imprint.divided();
    std::optional<Solid> new_a = solid_of_parts(divided[0]), new_b = solid_of_parts(divided[1]);
    if (!new_a || !new_b) return std::nullopt;
    return Imprinted{*std::move(new_a), *std::move(new_b), imprint.moved_mm()};
  } catch (const NotDivided&) {
    return std::nullopt;
  } catch (const PlaneTriangulation::Intersection_of_constraints_exception&) {
    return std::nullopt;
  }
}

}  // namespace octotomy::brep
