// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 find the points that neither operand has, and the triangles around them; 2 test these for intersections
// and triangles without area; 3 where there are any, contract sides and exchange diagonals of the thin
// triangles with a new point, until none is left or the steps are used up; 4 test again, and go on with a
// wider tolerance where triangles still intersect.
#include "brep/boolean/settle.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "brep/mesh/coordinate_order.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/morton_tree.h"
#include "brep/mesh/self_intersections.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
  void add(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  bool holds(const glm::dvec3& p) const {
    return glm::all(glm::greaterThanEqual(p, low)) && glm::all(glm::lessThanEqual(p, high));
  }
};

Box box_of(const Triangles& triangles) {
  Box box;
  for (const glm::dvec3& p : triangles.points_mm) box.add(p);
  return box;
}

/// Determines whether a point belongs to an operand or is new. All new points lie in the operands' common
/// box.
class Origins {
 public:
  explicit Origins(const std::array<const Triangles*, 2>& operands) {
    const Box a = box_of(*operands[0]), b = box_of(*operands[1]);
    for (const Box& box : {a, b})
      for (int axis = 0; axis < 3; ++axis)
        reach_mm_ = std::max({reach_mm_, std::abs(box.low[axis]), std::abs(box.high[axis])});
    common_ = {glm::max(a.low, b.low) - rounding_mm() * 16.0,
               glm::min(a.high, b.high) + rounding_mm() * 16.0};
    for (std::size_t k = 0; k < 2; ++k) {
      for (const glm::dvec3& p : operands[k]->points_mm)
        if (common_.holds(p)) given_mm_[k].push_back(p);
      std::sort(given_mm_[k].begin(), given_mm_[k].end(), is_before);
    }
  }

  /// One unit in the last place of the largest coordinate.
  double rounding_mm() const { return std::numeric_limits<double>::epsilon() * reach_mm_; }

  /// Marks the points in the common box.
  std::vector<std::uint8_t> in_common(const Triangles& surface) const {
    std::vector<std::uint8_t> is_in;
    is_in.reserve(surface.points_mm.size());
    for (const glm::dvec3& p : surface.points_mm) is_in.push_back(common_.holds(p));
    return is_in;
  }

  /// For each point in the common box: 1 if it is the first operand's, 2 if the second's, 3 if both have it,
  /// 0 if it is new. Points outside of the box get 3.
  std::vector<std::uint8_t> origins(const Triangles& surface) const {
    std::vector<std::uint8_t> origin(surface.points_mm.size(), 3);
    for (std::size_t v = 0; v < origin.size(); ++v) {
      const glm::dvec3& p = surface.points_mm[v];
      if (!common_.holds(p)) continue;
      origin[v] = 0;
      for (std::size_t k = 0; k < 2; ++k)
        if (std::binary_search(given_mm_[k].begin(), given_mm_[k].end(), p, is_before))
          origin[v] = static_cast<std::uint8_t>(origin[v] | (1U << k));
    }
    return origin;
  }

 private:
  static bool is_before(const glm::dvec3& p, const glm::dvec3& q) {
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
  }

  double reach_mm_ = 0.0;
  Box common_;
  std::array<std::vector<glm::dvec3>, 2> given_mm_;
};

/// Marks the corners of triangles that neither operand has: those with a new point, or with points of both
/// operands.
std::vector<std::uint8_t> corners_of_new(const Triangles& surface, const std::vector<std::uint8_t>& origin) {
  std::vector<std::uint8_t> is_corner(origin.size(), 0);
  for (const auto& face : surface.faces)
    if ((origin[face[0]] & origin[face[1]] & origin[face[2]]) == 0)
      for (const std::uint32_t v : face) is_corner[v] = 1;
  return is_corner;
}

/// The triangles with at least one marked corner.
std::vector<std::uint32_t> faces_at(const Triangles& surface, const std::vector<std::uint8_t>& is_marked) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < surface.faces.size(); ++f)
    if (const auto& face = surface.faces[f]; is_marked[face[0]] || is_marked[face[1]] || is_marked[face[2]])
      faces.push_back(f);
  return faces;
}

bool has_no_area(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
  return CGAL::collinear(Kernel::Point_3(p.x, p.y, p.z), Kernel::Point_3(q.x, q.y, q.z),
                         Kernel::Point_3(r.x, r.y, r.z));
}

/// Counts of defects beside new points at which later operations would fail.
struct Folds {
  std::size_t crossing = 0, flat = 0;
  glm::dvec3 at_mm{0.0};
  std::size_t count() const { return crossing + flat; }
};

Folds folds_of(const Triangles& surface, const std::vector<std::uint8_t>& is_marked) {
  Folds folds;
  Triangles near{surface.points_mm, {}};
  for (const std::uint32_t f : faces_at(surface, is_marked)) near.faces.push_back(surface.faces[f]);
  if (near.faces.empty()) return folds;
  std::vector<std::uint8_t> is_flat(near.faces.size(), 0);
  for (std::size_t i = 0; i < near.faces.size(); ++i) {
    const auto& face = near.faces[i];
    is_flat[i] = has_no_area(near.points_mm[face[0]], near.points_mm[face[1]], near.points_mm[face[2]]);
    folds.flat += is_flat[i];
  }
  const MortonTree tree(near);
  const SelfIntersections found = self_intersections({near, tree, is_flat, 1});
  folds.crossing = found.count;
  if (!found.first.empty()) folds.at_mm = near.points_mm[near.faces[found.first.front().first][0]];
  return folds;
}

struct Tolerances {
  double length_mm = 0.0;  ///< triangles of at most this height are thin
  double beside_mm = 0.0;  ///< largest distance by which the surface may move along its normal
};

/// Removes thin triangles beside new points where that does not move the surface by more than the tolerance.
class Settler {
 public:
  Settler(const Triangles& surface, std::vector<std::uint8_t> origin, const Tolerances& tolerances)
      : mesh_(mesh_of(surface)), origin_(std::move(origin)), tolerances_(tolerances) {
    origin_.resize(mesh_.n_vertices(), 0);
  }

  Triangles run() {
    for (const auto face : mesh_.faces()) look_at(face);
    std::size_t steps = 16 * waiting_.size() + 64;
    for (; !waiting_.empty() && steps > 0; --steps) {
      const Mesh::FaceHandle face = waiting_.front();
      waiting_.pop_front();
      if (!mesh_.status(face).deleted()) take_out(face);
    }
    mesh_.garbage_collection();
    return in_coordinate_order(mesh_);
  }

 private:
  Mesh::Point from(Mesh::HalfedgeHandle h) const { return mesh_.point(mesh_.from_vertex_handle(h)); }
  Mesh::Point to(Mesh::HalfedgeHandle h) const { return mesh_.point(mesh_.to_vertex_handle(h)); }
  double length(Mesh::HalfedgeHandle h) const { return (to(h) - from(h)).norm(); }
  std::uint8_t origin(Mesh::VertexHandle v) const { return origin_[static_cast<std::size_t>(v.idx())]; }

  /// The sides of a triangle in ascending length.
  std::array<Mesh::HalfedgeHandle, 3> sides(Mesh::FaceHandle face) const {
    const Mesh::HalfedgeHandle h = mesh_.halfedge_handle(face);
    std::array<Mesh::HalfedgeHandle, 3> sides{h, mesh_.next_halfedge_handle(h),
                                              mesh_.prev_halfedge_handle(h)};
    std::stable_sort(sides.begin(), sides.end(),
                     [&](auto one, auto other) { return length(one) < length(other); });
    return sides;
  }

  bool is_thin(Mesh::FaceHandle face) const {
    std::uint8_t common = 3;
    for (const auto v : mesh_.fv_range(face)) common &= origin(v);
    if (common != 0) return false;
    const auto by_length = sides(face);
    const Mesh::Point long_side = to(by_length[2]) - from(by_length[2]);
    const Mesh::Point short_side = to(by_length[0]) - from(by_length[0]);
    return cross(long_side, short_side).norm() <= tolerances_.length_mm * length(by_length[2]);
  }

  void look_at(Mesh::FaceHandle face) {
    if (face.is_valid() && is_thin(face)) waiting_.push_back(face);
  }

  void take_out(Mesh::FaceHandle face) {
    if (!is_thin(face)) return;
    const auto by_length = sides(face);
    if (length(by_length[0]) <= tolerances_.length_mm) {
      const Mesh::HalfedgeHandle h = by_length[0], turned = mesh_.opposite_halfedge_handle(h);
      const bool is_older = is_before(mesh_.from_vertex_handle(h), mesh_.to_vertex_handle(h));
      if (contract(is_older ? turned : h) || contract(is_older ? h : turned)) return;
    }
    exchange(by_length[2]);
  }

  /// An order of points in which those of the operands come before new ones.
  bool is_before(Mesh::VertexHandle v, Mesh::VertexHandle w) const {
    const bool is_v_new = origin(v) == 0, is_w_new = origin(w) == 0;
    return is_v_new != is_w_new ? is_w_new : v.idx() < w.idx();
  }

  /// Moves the first end of a side onto the second, if the tolerance allows it; returns whether it did.
  bool contract(Mesh::HalfedgeHandle h) {
    if (!mesh_.is_collapse_ok(h)) return false;
    const Mesh::Point moved = to(h) - from(h);
    double volume_mm3 = 0.0, area_mm2 = 0.0;  // six times the volume and six times the area
    for (const auto face : mesh_.vf_range(mesh_.from_vertex_handle(h))) {
      const Mesh::HalfedgeHandle side = mesh_.halfedge_handle(face);
      const Mesh::Point normal =
          cross(to(side) - from(side), to(mesh_.next_halfedge_handle(side)) - from(side));
      volume_mm3 += std::abs(dot(normal, moved));
      area_mm2 += 3.0 * normal.norm();
    }
    if (volume_mm3 > tolerances_.beside_mm * area_mm2) return false;
    const Mesh::VertexHandle kept = mesh_.to_vertex_handle(h);
    mesh_.collapse(h);
    for (const auto face : mesh_.vf_range(kept)) look_at(face);
    return true;
  }

  void exchange(Mesh::HalfedgeHandle h) {
    const Mesh::EdgeHandle edge = mesh_.edge_handle(h);
    if (mesh_.is_boundary(edge) || !mesh_.is_flip_ok(edge)) return;
    const Mesh::Point along = to(h) - from(h), one = to(mesh_.next_halfedge_handle(h)) - from(h),
                      other = to(mesh_.next_halfedge_handle(mesh_.opposite_halfedge_handle(h))) - from(h);
    const double volume_mm3 = std::abs(dot(cross(along, one), other));
    const double area_mm2 = 3.0 * (cross(along, one).norm() + cross(along, other).norm());
    if (volume_mm3 > tolerances_.beside_mm * area_mm2) return;
    mesh_.flip(edge);
    look_at(mesh_.face_handle(mesh_.halfedge_handle(edge, 0)));
    look_at(mesh_.face_handle(mesh_.halfedge_handle(edge, 1)));
  }

  Mesh mesh_;
  std::vector<std::uint8_t> origin_;
  Tolerances tolerances_;
  std::deque<Mesh::FaceHandle> waiting_;
};

}  // namespace

Settled settled(Triangles surface, const std::array<const Triangles*, 2>& operands, SettleReach reach) {
  assert(operands[0] != nullptr && operands[1] != nullptr);
  Settled best{std::move(surface)};
  const Origins points(operands);
  const auto folds_in = [&](const Triangles& tried) {
    return folds_of(tried, reach == SettleReach::CommonBox ? points.in_common(tried)
                                                           : corners_of_new(tried, points.origins(tried)));
  };
  Folds least = folds_in(best.surface);
  constexpr double last = 0x1p34;
  for (double roundings = 0x1p4; roundings <= last && least.count() > 0; roundings *= 0x1p6) {
    const Tolerances tolerances{roundings * points.rounding_mm(),
                                std::min(roundings, 0x1p6) * points.rounding_mm()};
    Triangles tried = Settler(best.surface, points.origins(best.surface), tolerances).run();
    const Folds folds = folds_in(tried);
    if (folds.count() >= least.count()) continue;
    least = folds;
    best.surface = std::move(tried);
  }
  best.crossing = least.crossing;
  best.flat = least.flat;
  best.at_mm = least.at_mm;
  return best;
}

}  // namespace octotomy::brep
