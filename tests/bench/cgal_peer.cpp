// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/cgal_peer.h"

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>
#include <algorithm>

#include "brep/mesh/distance.h"

namespace octotomy::bench {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 point_of(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

}  // namespace

struct CgalSurface::Mesh {
  CGAL::Surface_mesh<Kernel::Point_3> surface;
};

CgalSurface::CgalSurface(const brep::Triangles& triangles) : mesh_(std::make_unique<Mesh>()) {
  using Index = CGAL::Surface_mesh<Kernel::Point_3>::Vertex_index;
  for (const glm::dvec3& p : triangles.points_mm) mesh_->surface.add_vertex(point_of(p));
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

struct SegmentQuestions::Trees {
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  using Primitive = CGAL::AABB_face_graph_triangle_primitive<Surface>;

  brep::Triangles triangles;
  brep::SurfaceTree ours{triangles, brep::SurfaceTree::Build::ForSegments};
  Surface surface{};
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> cgal{};
};

SegmentQuestions::SegmentQuestions(const brep::Triangles& triangles)
    : trees_(std::make_unique<Trees>(Trees{triangles})) {
  using Index = Trees::Surface::Vertex_index;
  for (const glm::dvec3& p : triangles.points_mm) trees_->surface.add_vertex(point_of(p));
  for (const auto& face : triangles.faces)
    trees_->surface.add_face(Index(face[0]), Index(face[1]), Index(face[2]));
  trees_->cgal.insert(faces(trees_->surface).first, faces(trees_->surface).second, trees_->surface);
  trees_->cgal.build();
}
SegmentQuestions::~SegmentQuestions() = default;

std::size_t SegmentQuestions::met_by_cgal(const Segments& segments) const {
  return static_cast<std::size_t>(std::count_if(segments.begin(), segments.end(), [&](const auto& ends) {
    return trees_->cgal
        .any_intersected_primitive(Kernel::Segment_3(point_of(ends.first), point_of(ends.second)))
        .has_value();
  }));
}

std::size_t SegmentQuestions::met_by_ours(const Segments& segments) const {
  const brep::Triangles& t = trees_->triangles;
  return static_cast<std::size_t>(std::count_if(segments.begin(), segments.end(), [&](const auto& ends) {
    const Kernel::Segment_3 segment(point_of(ends.first), point_of(ends.second));
    return trees_->ours.meets_any(ends.first, ends.second, [&](std::uint32_t face) {
      const auto& [a, b, c] = t.faces[face];
      return CGAL::do_intersect(
          Kernel::Triangle_3(point_of(t.points_mm[a]), point_of(t.points_mm[b]), point_of(t.points_mm[c])),
          segment);
    });
  }));
}

}  // namespace octotomy::bench
