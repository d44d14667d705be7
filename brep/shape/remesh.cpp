// SPDX-License-Identifier: AGPL-3.0-or-later
// Uses CGAL's own mesh, whose handles are numbers, so that results do not depend on addresses. Only this unit
// includes CGAL's remeshing, which is slow to compile. Constrained edges may be split, and collapsed along
// their line: otherwise edges longer than the target would stay long.
#include "brep/shape/remesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <stdexcept>
#include <string>

#include "brep/mesh/error.h"
#include "brep/mesh/surface_mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using VertexIndex = SurfaceMesh::Vertex_index;

void check(const Triangles& triangles, const RemeshOptions& options) {
  const auto refuse = [](const std::string& why) { throw InvalidInput("remesh: " + why); };
  if (!(options.edge_mm > 0.0)) refuse("the edge length must be positive");
  if (!(options.sharp_angle_deg >= 0.0 && options.sharp_angle_deg <= 180.0))
    refuse("the sharp angle must be between 0 and 180 degrees");
  if (options.rounds < 1) refuse("there must be at least one round");
  for (std::size_t f = 0; f < triangles.faces.size(); ++f) {
    const auto at = [&](std::size_t k) {
      const glm::dvec3& p = triangles.points_mm[triangles.faces[f][k]];
      return Kernel::Point_3(p.x, p.y, p.z);
    };
    if (CGAL::collinear(at(0), at(1), at(2)))
      refuse("triangle " + std::to_string(f) + " has no area: repair the mesh first");
  }
}

Triangles triangles_of(const SurfaceMesh& surface) {
  Triangles triangles;
  std::vector<std::uint32_t> number(surface.number_of_vertices() + surface.number_of_removed_vertices());
  for (const VertexIndex v : surface.vertices()) {
    if (surface.is_isolated(v)) continue;
    number[v] = static_cast<std::uint32_t>(triangles.points_mm.size());
    const Kernel::Point_3& p = surface.point(v);
    triangles.points_mm.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : surface.faces()) {
    std::array<std::uint32_t, 3> corners{};
    std::size_t k = 0;
    for (const VertexIndex v : surface.vertices_around_face(surface.halfedge(f))) corners[k++] = number[v];
    triangles.faces.push_back(corners);
  }
  return triangles;
}

}  // namespace

Mesh remesh(const Mesh& mesh, const RemeshOptions& options) {
  const Triangles triangles = brep::triangles_of(mesh);
  check(triangles, options);
  if (triangles.faces.empty()) return mesh;
  SurfaceMesh surface = surface_mesh_of<Kernel::Point_3>(triangles);
  auto kept = surface.add_property_map<SurfaceMesh::Edge_index, bool>("e:kept", false).first;
  pmp::detect_sharp_edges(surface, options.sharp_angle_deg, kept);
  for (const auto e : surface.edges())
    if (surface.is_border(e)) kept[e] = true;
  pmp::isotropic_remeshing(surface.faces(), options.edge_mm, surface,
                           CGAL::parameters::edge_is_constrained_map(kept)
                               .number_of_iterations(static_cast<unsigned>(options.rounds))
                               .number_of_relaxation_steps(1)
                               .collapse_constraints(true)
                               .protect_constraints(false));
  return mesh_of(triangles_of(surface));
}

}  // namespace octotomy::brep
