// SPDX-License-Identifier: AGPL-3.0-or-later
// A hole is closed by the triangulation of its border with the least sharpness and area. This triangulation
// is searched among the triangles of the border's Delaunay tetrahedra and, if none of those close it, among
// all triangles. Source: Liepa, "Filling holes in meshes", SGP 2003, and Zou et al., "An algorithm for
// triangulating multiple 3D polygons", SGP 2013, as implemented in CGAL. The search among all triangles is
// cubic in the border's sides, and the recursion of the Delaunay search is as deep as the border is long.
// Departure for long borders: corners are cut off until the border is short enough for a search. A corner is
// cut off by a triangle of two neighbouring sides, in order of the third side's length.
#include "brep/shape/fill_holes.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <algorithm>
#include <array>
#include <iterator>
#include <queue>
#include <tuple>

#include "brep/mesh/mesh_point.h"
#include "brep/mesh/surface_mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Halfedge = Surface::Halfedge_index;
using Patch = std::vector<Surface::Face_index>;

/// Largest number of sides of a border for a search of all triangulations.
constexpr std::size_t most_sides_for_all = 128;
/// Largest number of sides of a border for a search of its Delaunay tetrahedra. The worst case is a space
/// curve in which every two points are Delaunay neighbours.
constexpr std::size_t most_sides_for_delaunay = 1024;

glm::dvec3 point_of(const Mesh& mesh, std::uint32_t v) {
  return glm_of(mesh.point(Mesh::VertexHandle(static_cast<int>(v))));
}

/// Shortens the border of a hole by cutting off corners.
class CornerCut {
 public:
  CornerCut(Surface& surface, Halfedge border) : surface_(surface), border_(border) {
    for (const Halfedge h : surface.halfedges_around_face(border))
      normal_ = normal_ + CGAL::cross_product(from_start(surface.source(h)), from_start(surface.target(h)));
    for (const Halfedge h : surface.halfedges_around_face(border)) add(h);
  }

  /// Cuts off `count` corners, or fewer if no other can be cut off, and adds the triangles to the patch.
  void cut(std::size_t count, Patch& patch) {
    while (count > 0 && !corners_.empty()) {
      const Corner corner = corners_.top();
      corners_.pop();
      if (!can_cut(corner)) continue;
      const Halfedge before = surface_.prev(corner.in);
      const Halfedge inner = CGAL::Euler::add_face_to_border(before, corner.out, surface_);
      patch.push_back(surface_.face(inner));
      border_ = surface_.opposite(inner);
      add(before);
      add(border_);
      --count;
    }
  }
  Halfedge border() const { return border_; }

 private:
  /// A corner between two halfedges of the border.
  struct Corner {
    bool turns_over;  ///< its triangle faces opposite to the hole, as at a concave corner of a flat hole
    double length;    ///< squared length of the side that cuts it off
    Halfedge in, out;
    /// Corners with equal keys are cut in the order of their halfedges, for a deterministic result.
    bool operator<(const Corner& other) const {
      return std::tie(other.turns_over, other.length, other.in) < std::tie(turns_over, length, in);
    }
  };

  const Kernel::Point_3& point(Surface::Vertex_index v) const { return surface_.point(v); }
  Kernel::Vector_3 from_start(Surface::Vertex_index v) const {
    return point(v) - point(surface_.source(border_));
  }

  /// Adds the corner at the end of a halfedge of the border.
  void add(Halfedge in) {
    const Halfedge out = surface_.next(in);
    const Kernel::Point_3 &a = point(surface_.source(in)), &b = point(surface_.target(in)),
                          &c = point(surface_.target(out));
    if (CGAL::collinear(a, b, c)) return;
    const bool turns_over = CGAL::cross_product(b - a, c - a) * normal_ <= 0.0;
    corners_.push({turns_over, CGAL::squared_distance(a, c), in, out});
  }

  /// Whether the corner still exists and the side that cuts it off is not an edge of the surface yet.
  bool can_cut(const Corner& corner) const {
    return surface_.is_border(corner.in) && surface_.next(corner.in) == corner.out &&
           !surface_.halfedge(surface_.source(corner.in), surface_.target(corner.out)).is_valid();
  }

  Surface& surface_;
  Halfedge border_;
  Kernel::Vector_3 normal_{0.0, 0.0, 0.0};  ///< normal of the hole; for a flat hole its length is twice the
                                            ///< area
  std::priority_queue<Corner> corners_;
};

/// Closes a hole of `sides` sides by CGAL's triangulate_hole() and appends the triangles to `patch`. Above
/// most_sides_for_all sides, the cubic search is not used. Returns false if there is no triangulation.
bool search(Surface& surface, Halfedge border, std::size_t sides, Patch& patch) {
  const std::size_t before = patch.size();
  CGAL::Polygon_mesh_processing::triangulate_hole(
      surface, border, std::back_inserter(patch),
      CGAL::parameters::do_not_use_cubic_algorithm(sides > most_sides_for_all));
  return patch.size() > before;
}

/// Closes a hole of `sides` sides and returns the triangles, which are then part of the surface. Empty, and
/// the surface is unchanged, if no triangulation was found.
Patch patch_of(Surface& surface, Halfedge border, std::size_t sides) {
  Patch patch;
  if (sides <= most_sides_for_delaunay && search(surface, border, sides, patch)) return patch;
  if (sides <= most_sides_for_all) return patch;
  CornerCut corners(surface, border);
  for (const std::size_t most : {most_sides_for_delaunay, most_sides_for_all}) {
    if (sides <= most) continue;
    corners.cut(sides - patch.size() - most, patch);
    const std::size_t left = sides - patch.size();
    if (left <= most && search(surface, corners.border(), left, patch)) return patch;
  }
  for (auto f = patch.rbegin(); f != patch.rend(); ++f)
    CGAL::Euler::remove_face(surface.halfedge(*f), surface);
  return {};
}

/// Closes the hole in the surface, so that later holes do not use an edge that this one created.
void close(Surface& surface, Hole& hole) {
  const auto border =
      surface.halfedge(Surface::Vertex_index(hole.border[0]), Surface::Vertex_index(hole.border[1]));
  for (const auto f : patch_of(surface, border, hole.border.size())) {
    std::array<std::uint32_t, 3> face{};
    auto corner = face.begin();
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      *corner++ = static_cast<std::uint32_t>(v);
    hole.faces.push_back(face);
  }
}

}  // namespace

std::vector<Hole> holes(const Mesh& mesh, const std::optional<double>& longest_mm) {
  std::vector<Hole> holes;
  Surface surface = surface_mesh_of<Kernel::Point_3>(triangles_of(mesh));
  std::vector<bool> seen(mesh.n_halfedges(), false);
  for (const auto start : mesh.halfedges()) {
    if (!mesh.is_boundary(start) || seen[static_cast<std::size_t>(start.idx())]) continue;
    Hole hole;
    for (Mesh::HalfedgeHandle h = start; !seen[static_cast<std::size_t>(h.idx())];
         h = mesh.next_halfedge_handle(h)) {
      seen[static_cast<std::size_t>(h.idx())] = true;
      hole.border.push_back(static_cast<std::uint32_t>(mesh.from_vertex_handle(h).idx()));
    }
    for (std::size_t k = 0; k < hole.border.size(); ++k) {
      const glm::dvec3 p = point_of(mesh, hole.border[k]);
      hole.centre_mm += p / static_cast<double>(hole.border.size());
      hole.perimeter_mm += glm::distance(p, point_of(mesh, hole.border[(k + 1) % hole.border.size()]));
    }
    if (!longest_mm || hole.perimeter_mm <= *longest_mm) close(surface, hole);
    holes.push_back(std::move(hole));
  }
  return holes;
}

}  // namespace octotomy::brep
