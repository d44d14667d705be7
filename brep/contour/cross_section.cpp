// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 compute on which side of the plane each point lies; 2 from each triangle with points on both sides, walk
// from triangle to triangle through the edges that change sides, until the walk returns or the surface ends;
// 3 interpolate a point on each edge from the distances of its ends. The side of a point is computed once, so
// neighbouring triangles agree in spite of rounding.
#include "brep/contour/cross_section.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/mesh_point.h"

namespace octotomy::brep {
namespace {

class PlaneSection {
 public:
  PlaneSection(const Mesh& mesh, const Plane& plane)
      : mesh_(mesh), plane_(plane), height_(mesh.n_vertices()), is_passed_(mesh.n_faces(), false) {
    for (const auto v : mesh.vertices())
      height_[static_cast<std::size_t>(v.idx())] =
          glm::dot(glm_of(mesh.point(v)) - plane.origin_mm, plane.normal);
  }

  CrossSection run() {
    CrossSection section;
    for (const auto face : mesh_.faces()) {
      if (is_passed_[static_cast<std::size_t>(face.idx())]) continue;
      const Mesh::HalfedgeHandle entry = entry_of(face);
      if (entry.is_valid()) add(walk(entry), section);
    }
    return section;
  }

 private:
  bool is_above(Mesh::VertexHandle v) const { return height_[static_cast<std::size_t>(v.idx())] >= 0.0; }
  /// The halfedge of a face that runs from above to below. The section enters the face there, with the body
  /// on its left when seen against the normal.
  Mesh::HalfedgeHandle entry_of(Mesh::FaceHandle face) const {
    Mesh::HalfedgeHandle h = mesh_.halfedge_handle(face);
    for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h))
      if (is_above(mesh_.from_vertex_handle(h)) && !is_above(mesh_.to_vertex_handle(h))) return h;
    return Mesh::HalfedgeHandle();
  }
  Mesh::HalfedgeHandle exit_of(Mesh::HalfedgeHandle entry) const {
    assert(is_above(mesh_.from_vertex_handle(entry)) && !is_above(mesh_.to_vertex_handle(entry)));
    const Mesh::HalfedgeHandle after = mesh_.next_halfedge_handle(entry);
    return is_above(mesh_.to_vertex_handle(after)) ? after : mesh_.next_halfedge_handle(after);
  }

  glm::dvec2 point_on(Mesh::HalfedgeHandle h) const {
    // Interpolates from the lower end, so that both faces compute the same point.
    Mesh::VertexHandle low = mesh_.from_vertex_handle(h), high = mesh_.to_vertex_handle(h);
    if (is_above(low)) std::swap(low, high);
    const double below = -height_[static_cast<std::size_t>(low.idx())],
                 above = height_[static_cast<std::size_t>(high.idx())];
    assert(below > 0.0 && above >= 0.0);
    const glm::dvec3 from = glm_of(mesh_.point(low)) - plane_.origin_mm,
                     to = glm_of(mesh_.point(high)) - plane_.origin_mm;
    // If the upper end lies in the plane, it is the result, unrounded: all edges to this end then agree.
    const glm::dvec3 p = above == 0.0 ? to : from + below / (below + above) * (to - from);
    return {glm::dot(p, plane_.right), glm::dot(p, plane_.up)};
  }

  Contour walk(Mesh::HalfedgeHandle start) {
    // Follows an open line back to its beginning.
    Mesh::HalfedgeHandle entry = start;
    Contour contour;
    for (;;) {
      const Mesh::HalfedgeHandle before = mesh_.opposite_halfedge_handle(entry);
      if (mesh_.is_boundary(before)) {
        contour.closed = false;
        break;
      }
      entry = entry_of(mesh_.face_handle(before));
      assert(entry.is_valid());
      if (entry == start) break;
    }
    const Mesh::HalfedgeHandle first = entry;
    do {
      is_passed_[static_cast<std::size_t>(mesh_.face_handle(entry).idx())] = true;
      contour.points_mm.push_back(point_on(entry));
      const Mesh::HalfedgeHandle exit = exit_of(entry);
      entry = mesh_.opposite_halfedge_handle(exit);
      if (mesh_.is_boundary(entry)) {
        contour.points_mm.push_back(point_on(exit));
        break;
      }
    } while (entry != first);
    return contour;
  }

  static void add(Contour contour, CrossSection& section) {
    // Where the plane passes through a vertex, several edges produce the same point.
    auto& points = contour.points_mm;
    points.erase(std::unique(points.begin(), points.end()), points.end());
    while (contour.closed && points.size() > 1 && points.front() == points.back()) points.pop_back();
    if (points.size() < (contour.closed ? 3u : 2u)) return;
    section.perimeter_mm += perimeter_mm(contour);
    if (contour.closed)
      section.area_mm2 += signed_area_mm2(contour);
    else
      ++section.open;
    section.contours.push_back(std::move(contour));
  }

  const Mesh& mesh_;
  const Plane& plane_;
  std::vector<double> height_;
  std::vector<bool> is_passed_;
};

}  // namespace

Plane plane_through(const glm::dvec3& point_mm, const glm::dvec3& normal) {
  const double length = glm::length(normal);
  if (!(length > 0.0) || !std::isfinite(length) || !std::isfinite(glm::dot(point_mm, glm::dvec3(1.0))))
    throw InvalidInput("plane_through: a plane needs a finite point and a direction");
  Plane plane;
  plane.origin_mm = point_mm;
  plane.normal = normal / length;
  // Below this length, the component of z perpendicular to the normal has lost half of its digits.
  const double half_of_digits = std::sqrt(std::numeric_limits<double>::epsilon());
  const glm::dvec3 z(0, 0, 1), aside = z - plane.normal * plane.normal.z;
  const bool is_along_z = glm::length(aside) < half_of_digits;
  const glm::dvec3 front(0, -1, 0);
  plane.up = glm::normalize(is_along_z ? front - plane.normal * glm::dot(front, plane.normal) : aside);
  plane.right = glm::cross(plane.up, plane.normal);
  return plane;
}

CrossSection cross_section(const Mesh& mesh, const Plane& plane) {
  return PlaneSection(mesh, plane).run();
}

void part_touching(std::vector<Contour>& contours) {
  std::map<std::pair<double, double>, int> passes;  // how often contours pass each point
  for (const Contour& contour : contours)
    for (const glm::dvec2& p : contour.points_mm) ++passes[{p.x, p.y}];
  constexpr double share = 1.0 / 1024.0;
  for (Contour& contour : contours) {
    const std::vector<glm::dvec2> points = std::move(contour.points_mm);
    contour.points_mm.clear();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const bool is_end = !contour.closed && (k == 0 || k + 1 == points.size());
      const glm::dvec2& p = points[k];
      if (is_end || passes.at({p.x, p.y}) == 1) {
        contour.points_mm.push_back(p);
        continue;
      }
      contour.points_mm.push_back(glm::mix(p, points[(k + points.size() - 1) % points.size()], share));
      contour.points_mm.push_back(glm::mix(p, points[(k + 1) % points.size()], share));
    }
  }
}

}  // namespace octotomy::brep
