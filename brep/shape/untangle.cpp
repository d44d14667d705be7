// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/untangle.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
// Disables CGAL's assertions, so that a build with assertions does not abort where other builds continue:
// between its steps, CGAL's repair leaves vertices with two fans. It repairs them next, but its own
// assertions refuse them.
#undef CGAL_assertion
#undef CGAL_precondition
#undef CGAL_postcondition
#define CGAL_assertion(condition) (static_cast<void>(0))
#define CGAL_precondition(condition) (static_cast<void>(0))
#define CGAL_postcondition(condition) (static_cast<void>(0))
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <algorithm>
#include <array>
#include <set>

#include "brep/mesh/coordinate_order.h"
#include "brep/mesh/health.h"
#include "brep/mesh/surface_mesh.h"
#include "brep/mesh/triangle_places.h"

namespace octotomy::brep {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

Triangles triangles_of(Surface& surface) {
  surface.collect_garbage();
  Triangles triangles;
  for (const auto v : surface.vertices()) {
    const Kernel::Point_3& p = surface.point(v);
    triangles.points_mm.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : surface.faces()) {
    std::array<std::uint32_t, 3> face{};
    auto corner = face.begin();
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      *corner++ = static_cast<std::uint32_t>(v);
    triangles.faces.push_back(face);
  }
  return triangles;
}

}  // namespace

Untangled untangle(const Mesh& mesh) {
  const Triangles before = brep::triangles_of(mesh);
  Untangled untangled;
  untangled.surface = before;
  std::size_t intersections = health(before).self_intersections;
  // If a part passes through another, only a surface of another genus is free of intersections. The decision
  // uses health()'s count of remaining intersections, which differs from CGAL's.
  for (const bool keeps_genus : {true, false, false, false}) {
    if (intersections == 0) break;
    Surface surface = surface_mesh_of<Kernel::Point_3>(untangled.surface);
    pmp::experimental::remove_self_intersections(surface, CGAL::parameters::preserve_genus(keeps_genus));
    // Sorted, because CGAL's order may depend on addresses.
    Triangles tried = in_coordinate_order(mesh_of(triangles_of(surface)));
    const std::size_t still = health(tried).self_intersections;
    if (still >= intersections) continue;
    intersections = still;
    untangled.surface = std::move(tried);
  }
  untangled.is_done = intersections == 0;
  std::multiset<Places> rest;
  for (const auto& face : untangled.surface.faces) rest.insert(places_of(untangled.surface, face));
  for (std::uint32_t f = 0; f < before.faces.size(); ++f) {
    const auto found = rest.find(places_of(before, before.faces[f]));
    if (found == rest.end())
      untangled.removed.push_back(f);
    else
      rest.erase(found);
  }
  untangled.added = rest.size();
  return untangled;
}

}  // namespace octotomy::brep
