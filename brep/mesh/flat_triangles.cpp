// SPDX-License-Identifier: AGPL-3.0-or-later
// The three points of a triangle without area are collinear, so its middle point lies on its long side: the
// neighbour at that side, divided at the middle point, covers both. If the neighbour's far point is collinear
// too, the two new triangles are flat again. Therefore exchanges are counted: reducing a line of n points by
// one takes one exchange at best, n at worst.
#include "brep/mesh/flat_triangles.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <cassert>
#include <cmath>
#include <deque>
#include <limits>

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

template <typename Point>
Kernel::Point_3 exact(const Point& p) {
  return {p[0], p[1], p[2]};
}

/// Whether three points are collinear, exactly. For most triangles the rounded doubled area decides: its
/// error is less than eight roundings of the product of the longest sides.
template <typename Point>
bool is_flat(const Point& p, const Point& q, const Point& r) {
  assert(std::isfinite(p[0] + p[1] + p[2] + q[0] + q[1] + q[2] + r[0] + r[1] + r[2]));
  const double ux = q[0] - p[0], uy = q[1] - p[1], uz = q[2] - p[2];
  const double vx = r[0] - p[0], vy = r[1] - p[1], vz = r[2] - p[2];
  const double x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
  const double longest = (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz);
  constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
  if (x * x + y * y + z * z > rounding * rounding * longest && std::isnormal(longest)) return false;
  return CGAL::collinear(exact(p), exact(q), exact(r));
}

class Flattener {
 public:
  explicit Flattener(Mesh& mesh) : mesh_(mesh) {}

  FlatTriangles run() {
    for (const auto face : mesh_.faces())
      if (is_flat(face)) waiting_.push_back(face);
    if (waiting_.empty()) return done_;
    std::size_t steps = 64 * waiting_.size();
    for (; !waiting_.empty() && steps > 0; --steps) {
      const Mesh::FaceHandle face = waiting_.front();
      waiting_.pop_front();
      if (mesh_.status(face).deleted() || !is_flat(face)) continue;
      take_out(face);
    }
    mesh_.garbage_collection();
    for (const auto face : mesh_.faces()) done_.left += is_flat(face);
    return done_;
  }

 private:
  bool is_flat(Mesh::FaceHandle face) const {
    const Mesh::HalfedgeHandle h = mesh_.halfedge_handle(face);
    return brep::is_flat(mesh_.point(mesh_.from_vertex_handle(h)), mesh_.point(mesh_.to_vertex_handle(h)),
                         mesh_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h))));
  }
  double length(Mesh::HalfedgeHandle h) const {
    return (mesh_.point(mesh_.to_vertex_handle(h)) - mesh_.point(mesh_.from_vertex_handle(h))).sqrnorm();
  }
  void look_at_again(Mesh::FaceHandle face) {
    if (face.is_valid() && is_flat(face)) waiting_.push_back(face);
  }

  void take_out(Mesh::FaceHandle face) {
    assert(is_flat(face) && !mesh_.status(face).deleted());
    Mesh::HalfedgeHandle h = mesh_.halfedge_handle(face), longest = h;
    for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h)) {
      if (mesh_.point(mesh_.from_vertex_handle(h)) == mesh_.point(mesh_.to_vertex_handle(h)))
        return collapse(h);
      if (length(h) > length(longest)) longest = h;
    }
    const Mesh::EdgeHandle edge = mesh_.edge_handle(longest);
    if (mesh_.is_boundary(edge) || !mesh_.is_flip_ok(edge)) return;
    mesh_.flip(edge);
    ++done_.flips;
    look_at_again(mesh_.face_handle(mesh_.halfedge_handle(edge, 0)));
    look_at_again(mesh_.face_handle(mesh_.halfedge_handle(edge, 1)));
  }

  void collapse(Mesh::HalfedgeHandle h) {
    assert(length(h) == 0.0);
    if (!mesh_.is_collapse_ok(h)) return;
    mesh_.collapse(h);
    ++done_.collapses;
  }

  Mesh& mesh_;
  std::deque<Mesh::FaceHandle> waiting_;
  FlatTriangles done_;
};

}  // namespace

bool has_flat_triangles(const Triangles& triangles) {
  for (const auto& face : triangles.faces)
    if (is_flat(triangles.points_mm[face[0]], triangles.points_mm[face[1]], triangles.points_mm[face[2]]))
      return true;
  return false;
}

FlatTriangles take_out_flat_triangles(Mesh& mesh) {
  return Flattener(mesh).run();
}

}  // namespace octotomy::brep
