// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/fill_holes.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <array>
#include <iterator>

#include "brep/mesh/mesh_point.h"
#include "brep/mesh/surface_mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

glm::dvec3 point_of(const Mesh& mesh, std::uint32_t v) {
  return glm_of(mesh.point(Mesh::VertexHandle(static_cast<int>(v))));
}

/// Closes the hole in the surface, so that later ones do not take an edge that this one made.
void close(Surface& surface, Hole& hole) {
  const auto border =
      surface.halfedge(Surface::Vertex_index(hole.border[0]), Surface::Vertex_index(hole.border[1]));
  std::vector<Surface::Face_index> patch;
  CGAL::Polygon_mesh_processing::triangulate_hole(surface, border, std::back_inserter(patch));
  for (const auto f : patch) {
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
