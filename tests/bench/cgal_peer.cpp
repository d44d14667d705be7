// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/cgal_peer.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>

namespace octotomy::bench {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

}  // namespace

struct CgalSurface::Mesh {
  CGAL::Surface_mesh<Kernel::Point_3> surface;
};

CgalSurface::CgalSurface(const brep::Triangles& triangles) : mesh_(std::make_unique<Mesh>()) {
  using Index = CGAL::Surface_mesh<Kernel::Point_3>::Vertex_index;
  for (const glm::dvec3& p : triangles.points_mm) mesh_->surface.add_vertex(Kernel::Point_3(p.x, p.y, p.z));
  for (const auto& face : triangles.faces)
    mesh_->surface.add_face(Index(face[0]), Index(face[1]), Index(face[2]));
}
CgalSurface::CgalSurface(std::unique_ptr<Mesh> mesh) : mesh_(std::move(mesh)) {}
CgalSurface::~CgalSurface() = default;
CgalSurface::CgalSurface(CgalSurface&&) noexcept = default;

CgalSurface CgalSurface::copy() const {
  return CgalSurface(std::make_unique<Mesh>(*mesh_));
}

std::size_t CgalSurface::boolean(CgalSurface& a, CgalSurface& b, Operation operation) {
  CGAL::Surface_mesh<Kernel::Point_3> result;
  if (operation == Operation::Union)
    pmp::corefine_and_compute_union(a.mesh_->surface, b.mesh_->surface, result);
  else
    pmp::corefine_and_compute_difference(a.mesh_->surface, b.mesh_->surface, result);
  return result.number_of_faces();
}

double CgalSurface::volume_and_area() const {
  return pmp::volume(mesh_->surface) + pmp::area(mesh_->surface);
}

}  // namespace octotomy::bench
