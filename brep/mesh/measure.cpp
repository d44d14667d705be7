// SPDX-License-Identifier: AGPL-3.0-or-later
// Sums run over blocks of 64 faces, term by term, then over the blocks in pairs: the error grows with 64 and
// log n instead of n (Higham, "The accuracy of floating point summation", 1993), and sums do not depend on
// the number of threads.
#include "brep/mesh/measure.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vector>

#include "brep/mesh/dihedral_angle.h"
#include "brep/mesh/mesh_point.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t block_size = 64;
/// Blocks per task: about 100 us of work.
constexpr std::size_t blocks_a_task = 128;

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

/// Calls run(block, begin, end) for each block of `count` items, in parallel.
template <typename Run>
void for_each_block(std::size_t count, const Run& run) {
  const tbb::blocked_range<std::size_t> blocks(0, (count + block_size - 1) / block_size, blocks_a_task);
  tbb::parallel_for(blocks, [&](const auto& range) {
    for (std::size_t block = range.begin(); block != range.end(); ++block)
      run(block, block * block_size, std::min(count, (block + 1) * block_size));
  });
}

template <typename Term, typename TermAt>
Term blockwise_sum(std::size_t count, const TermAt& term_at) {
  std::vector<Term> sums((count + block_size - 1) / block_size, Term(0.0));
  for_each_block(count, [&](std::size_t block, std::size_t begin, std::size_t end) {
    Term sum(0.0);
    for (std::size_t i = begin; i < end; ++i) sum += term_at(i);
    sums[block] = sum;
  });
  return pairwise_sum<Term>(sums);
}

struct Corners {
  glm::dvec3 a, b, c;
};

/// Access to triangles of a mesh or a list.
struct MeshCorners {
  const Mesh& mesh;
  std::size_t count() const { return mesh.n_faces(); }
  Corners operator()(std::size_t f) const {
    assert(f < count() && !mesh.status(Mesh::FaceHandle(static_cast<int>(f))).deleted());
    const Mesh::HalfedgeHandle h = mesh.halfedge_handle(Mesh::FaceHandle(static_cast<int>(f)));
    return {end_of(mesh.prev_halfedge_handle(h)), end_of(h), end_of(mesh.next_halfedge_handle(h))};
  }
  glm::dvec3 end_of(Mesh::HalfedgeHandle h) const { return glm_of(mesh.point(mesh.to_vertex_handle(h))); }

  /// The number of points for visit_point(), which skips isolated ones.
  std::size_t point_count() const { return mesh.n_vertices(); }
  template <typename Visit>
  void visit_point(std::size_t i, const Visit& visit) const {
    const Mesh::VertexHandle v(static_cast<int>(i));
    if (!mesh.is_isolated(v)) visit(glm_of(mesh.point(v)));
  }
};

struct ListCorners {
  const Triangles& triangles;
  std::size_t count() const { return triangles.faces.size(); }
  Corners operator()(std::size_t f) const {
    const auto& face = triangles.faces[f];
    assert(std::max({face[0], face[1], face[2]}) < triangles.points_mm.size());
    return {triangles.points_mm[face[0]], triangles.points_mm[face[1]], triangles.points_mm[face[2]]};
  }

  /// visit_point() visits the points of one triangle: only triangles show which points of a list are in use.
  std::size_t point_count() const { return count(); }
  template <typename Visit>
  void visit_point(std::size_t i, const Visit& visit) const {
    for (const std::uint32_t v : triangles.faces[i]) visit(triangles.points_mm[v]);
  }
};

struct LinkedCorners : ListCorners {
  explicit LinkedCorners(const Linked& source) : ListCorners{source.triangles}, linked(source) {}
  const Linked& linked;
};

glm::dvec3 normal_of(const Corners& t) {
  return glm::cross(t.b - t.a, t.c - t.a);
}

struct Extents {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
  glm::dvec3 centre() const { return low + 0.5 * (high - low); }
  void add(const Extents& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
};

template <typename Source>
Extents extents_of(const Source& source) {
  std::vector<Extents> of_blocks((source.point_count() + block_size - 1) / block_size);
  for_each_block(source.point_count(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    Extents extents;
    for (std::size_t i = begin; i < end; ++i)
      source.visit_point(i, [&](const glm::dvec3& p) { extents.add({p, p}); });
    of_blocks[block] = extents;
  });
  Extents extents;
  for (const Extents& block : of_blocks) extents.add(block);
  return extents;
}

/// The volume of the cone from a point to a triangle.
double cone_mm3(const Corners& t, const glm::dvec3& tip) {
  return glm::dot(t.a - tip, normal_of(t)) / 6.0;
}

template <typename Source>
double volume_about(const Source& source, const glm::dvec3& tip) {
  return blockwise_sum<double>(source.count(), [&](std::size_t f) { return cone_mm3(source(f), tip); });
}

template <typename Source>
Size size_from(const Source& source) {
  if (source.count() == 0) return {};
  const Extents extents = extents_of(source);
  const glm::dvec3 tip = extents.centre();
  // Computes volume and area in one pass, because reading the points dominates the cost.
  const auto sums = blockwise_sum<glm::dvec2>(source.count(), [&](std::size_t f) {
    const Corners t = source(f);
    const glm::dvec3 normal = normal_of(t);
    return glm::dvec2(glm::dot(t.a - tip, normal) / 6.0, 0.5 * glm::length(normal));
  });
  return {sums.x, sums.y, extents.low, extents.high};
}

/// Half the edge's length times the unsigned angle between the faces' normals n and m.
double edge_curvature_mm(const glm::dvec3& n, const glm::dvec3& m, const glm::dvec3& along) {
  return 0.5 * glm::length(along) * std::abs(dihedral_angle(n, m, along));
}

/// Edges with one triangle are skipped. `normals` are in the order of the faces.
double absolute_mean_curvature_mm(const MeshCorners& source, const std::vector<glm::dvec3>& normals) {
  const Mesh& mesh = source.mesh;
  assert(normals.size() == mesh.n_faces());
  return blockwise_sum<double>(mesh.n_edges(), [&](std::size_t i) {
    const Mesh::EdgeHandle e(static_cast<int>(i));
    if (mesh.is_boundary(e)) return 0.0;
    const Mesh::HalfedgeHandle h = mesh.halfedge_handle(e, 0), g = mesh.halfedge_handle(e, 1);
    return edge_curvature_mm(
        normals[static_cast<std::size_t>(mesh.face_handle(h).idx())],
        normals[static_cast<std::size_t>(mesh.face_handle(g).idx())],
        glm_of(mesh.point(mesh.to_vertex_handle(h))) - glm_of(mesh.point(mesh.to_vertex_handle(g))));
  });
}

/// Edges in the order of mesh_of(): by the first of their sides.
double absolute_mean_curvature_mm(const LinkedCorners& source, const std::vector<glm::dvec3>& normals) {
  const Linked& linked = source.linked;
  std::vector<std::uint32_t> edges;
  edges.reserve(linked.opposite.size() / 2);
  for (std::uint32_t side = 0; side < linked.opposite.size(); ++side)
    if (linked.is_inner_edge(side)) edges.push_back(side);
  const std::vector<glm::dvec3>& p = linked.triangles.points_mm;
  return blockwise_sum<double>(edges.size(), [&](std::size_t i) {
    const std::uint32_t side = edges[i];
    return edge_curvature_mm(normals[side / 3], normals[linked.opposite[side] / 3],
                             p[linked.to(side)] - p[linked.from(side)]);
  });
}

/// Integrals of x x, y y, z z and of y z, z x, x y.
struct SecondMoments {
  glm::dvec3 squares, products;
  explicit SecondMoments(double value = 0.0) : squares(value), products(value) {}
  SecondMoments& operator+=(const SecondMoments& other) {
    squares += other.squares;
    products += other.products;
    return *this;
  }
  friend SecondMoments operator+(SecondMoments a, const SecondMoments& b) { return a += b; }
};

glm::dvec3 products_of(const glm::dvec3& p, const glm::dvec3& q) {
  return 0.5 * glm::dvec3(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
}

/// Second moments of the cone from `tip`, about `tip`. Those of a tetrahedron are V / 20 (sum of p p over its
/// corners + s s), where s is the sum of the corners p and the tip's p is zero.
SecondMoments second_moments(const Corners& t, const glm::dvec3& tip) {
  const glm::dvec3 a = t.a - tip, b = t.b - tip, c = t.c - tip, sum = a + b + c;
  const double share = cone_mm3(t, tip) / 20.0;
  SecondMoments moments;
  moments.squares = share * (a * a + b * b + c * c + sum * sum);
  moments.products =
      share * (products_of(a, a) + products_of(b, b) + products_of(c, c) + products_of(sum, sum));
  return moments;
}

/// The inertia tensor about the centroid, which lies at `arm` from the point about which the moments were
/// computed (Steiner).
glm::dmat3 inertia_of(SecondMoments moments, double volume, const glm::dvec3& arm) {
  assert(volume != 0.0);
  moments.squares -= volume * arm * arm;
  moments.products -= volume * products_of(arm, arm);
  const glm::dvec3 &s = moments.squares, &p = moments.products;
  return {s.y + s.z, -p.z, -p.y, -p.z, s.z + s.x, -p.x, -p.y, -p.x, s.x + s.y};
}

template <typename Source>
Measures measures_from(const Source& source) {
  Measures measures;
  if (source.count() == 0) return measures;
  const Size size = size_from(source);
  measures.volume_mm3 = size.volume_mm3;
  measures.area_mm2 = size.area_mm2;
  measures.low_mm = size.low_mm;
  measures.high_mm = size.high_mm;

  const glm::dvec3 centre = size.low_mm + 0.5 * (size.high_mm - size.low_mm);
  std::vector<glm::dvec3> normals(source.count());
  const auto moments = blockwise_sum<glm::dvec3>(source.count(), [&](std::size_t f) {
    const Corners t = source(f);
    normals[f] = normal_of(t);
    return 0.25 * cone_mm3(t, centre) * ((t.a - centre) + (t.b - centre) + (t.c - centre));
  });
  if (measures.volume_mm3 != 0.0) {
    const glm::dvec3 arm = moments / measures.volume_mm3;
    measures.centroid_mm = centre + arm;
    const auto second = blockwise_sum<SecondMoments>(
        source.count(), [&](std::size_t f) { return second_moments(source(f), centre); });
    measures.inertia_mm5 = inertia_of(second, measures.volume_mm3, arm);
  }
  measures.absolute_mean_curvature_mm = absolute_mean_curvature_mm(source, normals);
  return measures;
}

}  // namespace

Size size_of(const Triangles& triangles) {
  return size_from(ListCorners{triangles});
}

Size size_of(const Mesh& mesh) {
  return size_from(MeshCorners{mesh});
}

double volume_mm3(const Mesh& mesh) {
  const MeshCorners source{mesh};
  return source.count() == 0 ? 0.0 : volume_about(source, extents_of(source).centre());
}

Measures measure(const Mesh& mesh) {
  return measures_from(MeshCorners{mesh});
}

Measures measure(const Linked& linked) {
  return measures_from(LinkedCorners(linked));
}

long euler_number(const Triangles& surface) {
  std::vector<std::uint8_t> used(surface.points_mm.size(), 0);
  for (const auto& face : surface.faces)
    for (const std::uint32_t v : face) used[v] = 1;
  // Each triangle has three half edges.
  return std::count(used.begin(), used.end(), 1) - static_cast<long>(surface.faces.size() / 2);
}

}  // namespace octotomy::brep
