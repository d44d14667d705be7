// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace octotomy::brep {
namespace {

glm::dvec3 glm_of(const Mesh::Point& p) {
  return {p[0], p[1], p[2]};
}

/// Pairwise sum in the order of the terms: the error grows with log n instead of n (Higham 1993).
template <typename Term>
Term pairwise_sum(std::span<const Term> terms) {
  if (terms.size() <= 8) {
    Term sum{0.0};
    for (const Term& term : terms) sum += term;
    return sum;
  }
  const std::size_t half = terms.size() / 2;
  return pairwise_sum(terms.first(half)) + pairwise_sum(terms.subspan(half));
}

struct Corners {
  glm::dvec3 a, b, c;
};

Corners corners_of(const Mesh& mesh, Mesh::FaceHandle face) {
  const Mesh::HalfedgeHandle h = mesh.halfedge_handle(face);
  return {glm_of(mesh.point(mesh.from_vertex_handle(h))), glm_of(mesh.point(mesh.to_vertex_handle(h))),
          glm_of(mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h))))};
}

glm::dvec3 normal_of(const Corners& t) {
  return glm::cross(t.b - t.a, t.c - t.a);
}

glm::dvec3 end_of(const Mesh& mesh, Mesh::HalfedgeHandle h) {
  return glm_of(mesh.point(mesh.to_vertex_handle(h)));
}

struct Extents {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
  glm::dvec3 centre() const { return low + 0.5 * (high - low); }
};

Extents extents_of(const std::vector<Corners>& triangles) {
  Extents extents;
  for (const Corners& t : triangles) {
    extents.low = glm::min(extents.low, glm::min(t.a, glm::min(t.b, t.c)));
    extents.high = glm::max(extents.high, glm::max(t.a, glm::max(t.b, t.c)));
  }
  return extents;
}

std::vector<Corners> triangles_in(const Mesh& mesh) {
  std::vector<Corners> triangles;
  triangles.reserve(mesh.n_faces());
  for (const auto f : mesh.faces()) triangles.push_back(corners_of(mesh, f));
  return triangles;
}

/// The cone from a point to a triangle.
double cone_mm3(const Corners& t, const glm::dvec3& tip) {
  return glm::dot(t.a - tip, normal_of(t)) / 6.0;
}

double sum_cones_mm3(const std::vector<Corners>& triangles, const glm::dvec3& tip) {
  std::vector<double> volumes;
  volumes.reserve(triangles.size());
  for (const Corners& t : triangles) volumes.push_back(cone_mm3(t, tip));
  return pairwise_sum<double>(volumes);
}

/// Half of length times unsigned angle between the faces' normals n and m; atan2 keeps small angles exact
/// where acos does not.
double edge_curvature_mm(const glm::dvec3& n, const glm::dvec3& m, double length_mm) {
  if (glm::dot(n, n) == 0.0 || glm::dot(m, m) == 0.0) return 0.0;
  return 0.5 * length_mm * std::atan2(glm::length(glm::cross(n, m)), glm::dot(n, m));
}

/// Precondition: normals are in the order of the faces.
double absolute_mean_curvature_mm(const Mesh& mesh, const std::vector<glm::dvec3>& normals) {
  std::vector<double> curvatures;
  curvatures.reserve(mesh.n_edges());
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    const Mesh::HalfedgeHandle h = mesh.halfedge_handle(e, 0), g = mesh.halfedge_handle(e, 1);
    curvatures.push_back(edge_curvature_mm(normals[static_cast<std::size_t>(mesh.face_handle(h).idx())],
                                           normals[static_cast<std::size_t>(mesh.face_handle(g).idx())],
                                           glm::distance(end_of(mesh, h), end_of(mesh, g))));
  }
  return pairwise_sum<double>(curvatures);
}

}  // namespace

double volume_mm3(const Mesh& mesh) {
  if (mesh.n_faces() == 0) return 0.0;
  const std::vector<Corners> triangles = triangles_in(mesh);
  return sum_cones_mm3(triangles, extents_of(triangles).centre());
}

Measures measure(const Mesh& mesh) {
  Measures measures;
  if (mesh.n_faces() == 0) return measures;
  const std::vector<Corners> triangles = triangles_in(mesh);
  const Extents extents = extents_of(triangles);
  const glm::dvec3 centre = extents.centre();
  measures.low_mm = extents.low;
  measures.high_mm = extents.high;
  measures.volume_mm3 = sum_cones_mm3(triangles, centre);

  std::vector<double> areas;
  std::vector<glm::dvec3> moments, normals;
  areas.reserve(triangles.size());
  moments.reserve(triangles.size());
  normals.reserve(triangles.size());
  for (const Corners& t : triangles) {
    normals.push_back(normal_of(t));
    areas.push_back(0.5 * glm::length(normals.back()));
    moments.push_back(0.25 * cone_mm3(t, centre) * ((t.a - centre) + (t.b - centre) + (t.c - centre)));
  }
  measures.area_mm2 = pairwise_sum<double>(areas);
  if (measures.volume_mm3 != 0.0)
    measures.centroid_mm = centre + pairwise_sum<glm::dvec3>(moments) / measures.volume_mm3;
  measures.absolute_mean_curvature_mm = absolute_mean_curvature_mm(mesh, normals);
  return measures;
}

}  // namespace octotomy::brep
