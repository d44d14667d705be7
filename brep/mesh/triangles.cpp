// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/triangles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/sides.h"

// The halfedge structure is written directly rather than by add_face, which prints to the standard error,
// depends on the order of the triangles at vertices where several fans meet, and cannot say what is wrong.
// 1 refuse triangles that are none; 2 pair halfedges by sorting those of each point; 3 tell the fans at each
// point apart; 4 write edges, faces and the loops along the boundary.

namespace octotomy::brep {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

[[noreturn]] void refuse(std::size_t face, const std::string& why, const std::string& advice) {
  throw Error(ErrorCode::Input, "triangle " + std::to_string(face) + " " + why + "; " + advice);
}

void check_triangles(const Triangles& triangles) {
  // Three corners of each triangle are numbered in 32 bits.
  if (triangles.faces.size() >= none / 3 || triangles.points_mm.size() >= none / 2)
    throw Error(ErrorCode::Resource, "a mesh of " + std::to_string(triangles.faces.size()) +
                                         " triangles is more than 32-bit numbers hold; reduce it first");
  for (std::size_t f = 0; f < triangles.faces.size(); ++f) {
    const auto& face = triangles.faces[f];
    for (const std::uint32_t v : face) {
      if (v >= triangles.points_mm.size())
        refuse(f,
               "refers to point " + std::to_string(v) + " of " + std::to_string(triangles.points_mm.size()),
               "the file or generator is at fault");
      const glm::dvec3& p = triangles.points_mm[v];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        refuse(f, "has a point that is not finite", "the file or generator is at fault");
    }
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0])
      refuse(f, "repeats a point", "remove triangles without area first");
  }
}

/// For each halfedge, numbered by the corner it leaves, the one along the same edge the other way, or none.
std::vector<std::uint32_t> pair_halfedges(const Triangles& triangles) {
  std::vector<std::uint32_t> opposite(3 * triangles.faces.size(), none);
  std::uint32_t offender = none;
  bool too_many = false;
  each_edge(sorted_sides(triangles), [&](const Side* begin, const Side* end) {
    if (end - begin == 1) return;
    const bool same_way = begin[0].upward == begin[1].upward;
    if (same_way || end - begin > 2) {
      const std::uint32_t culprit = (same_way ? begin[1] : begin[2]).corner / 3;
      if (culprit < offender) {
        offender = culprit;
        too_many = !same_way;
      }
      return;
    }
    opposite[begin[0].corner] = begin[1].corner;
    opposite[begin[1].corner] = begin[0].corner;
  });
  if (offender != none)
    refuse(offender,
           too_many ? "is the third along one of its edges" : "runs along an edge the same way as another",
           "ask for the health of the triangles and repair or separate them first");
  return opposite;
}

/// Adds a vertex for each point and for each further fan about it; returns the vertex of each corner. The fan
/// whose corner comes first has the point's own.
std::vector<Mesh::VertexHandle> place_corners(const Triangles& triangles,
                                              const std::vector<std::uint32_t>& opposite,
                                              std::vector<glm::dvec3>& copies_mm) {
  std::vector<std::uint8_t> has_fan(triangles.points_mm.size(), 0);
  std::vector<Mesh::VertexHandle> of_corner(opposite.size());
  for (std::uint32_t c = 0; c < opposite.size(); ++c) {
    if (of_corner[c].is_valid()) continue;
    const std::uint32_t v = triangles.faces[c / 3][c % 3];
    Mesh::VertexHandle vertex(static_cast<int>(v));
    if (has_fan[v]) {
      vertex = Mesh::VertexHandle(static_cast<int>(triangles.points_mm.size() + copies_mm.size()));
      copies_mm.push_back(triangles.points_mm[v]);
    }
    has_fan[v] = 1;
    // All round the point one way; at a boundary the rest of the fan lies the other way.
    std::uint32_t turning = c;
    do {
      of_corner[turning] = vertex;
      turning = opposite[turning] == none ? none : next_corner(opposite[turning]);
    } while (turning != none && turning != c);
    for (turning = turning == none ? opposite[previous_corner(c)] : none; turning != none;
         turning = opposite[previous_corner(turning)])
      of_corner[turning] = vertex;
  }
  return of_corner;
}

}  // namespace

void check_joins(const Triangles& triangles) {
  check_triangles(triangles);
  pair_halfedges(triangles);
}

Mesh mesh_of(const Triangles& triangles) {
  check_triangles(triangles);
  const std::vector<std::uint32_t> opposite = pair_halfedges(triangles);
  std::vector<glm::dvec3> copies_mm;
  const std::vector<Mesh::VertexHandle> vertex = place_corners(triangles, opposite, copies_mm);

  // An edge is numbered by the first of its corners, whose halfedge is the edge's first.
  std::vector<Mesh::HalfedgeHandle> halfedge(opposite.size());
  int edge_count = 0;
  for (std::uint32_t c = 0; c < opposite.size(); ++c)
    halfedge[c] = opposite[c] < c ? Mesh::HalfedgeHandle(halfedge[opposite[c]].idx() + 1)
                                  : Mesh::HalfedgeHandle(2 * edge_count++);

  const std::size_t point_count = triangles.points_mm.size();
  Mesh mesh;
  mesh.resize(point_count + copies_mm.size(), static_cast<std::size_t>(edge_count), triangles.faces.size());
  for (std::size_t v = 0; v < point_count + copies_mm.size(); ++v) {
    const glm::dvec3& p = v < point_count ? triangles.points_mm[v] : copies_mm[v - point_count];
    mesh.set_point(Mesh::VertexHandle(static_cast<int>(v)), Mesh::Point(p.x, p.y, p.z));
  }
  std::vector<Mesh::HalfedgeHandle> boundary;
  for (std::uint32_t c = 0; c < opposite.size(); ++c) {
    const Mesh::FaceHandle face(static_cast<int>(c / 3));
    if (c % 3 == 0) mesh.set_halfedge_handle(face, halfedge[c]);
    mesh.set_vertex_handle(halfedge[c], vertex[next_corner(c)]);
    mesh.set_face_handle(halfedge[c], face);
    mesh.set_next_halfedge_handle(halfedge[c], halfedge[next_corner(c)]);
    mesh.set_halfedge_handle(vertex[c], halfedge[c]);
    if (opposite[c] != none) continue;
    boundary.push_back(mesh.opposite_halfedge_handle(halfedge[c]));
    mesh.set_vertex_handle(boundary.back(), vertex[c]);
  }

  // As every fan has its own vertex, at most one boundary halfedge leaves each; a vertex must point to it.
  for (const Mesh::HalfedgeHandle outside : boundary) {
    mesh.set_boundary(outside);
    mesh.set_halfedge_handle(mesh.from_vertex_handle(outside), outside);
  }
  for (const Mesh::HalfedgeHandle outside : boundary)
    mesh.set_next_halfedge_handle(outside, mesh.halfedge_handle(mesh.to_vertex_handle(outside)));
  return mesh;
}

Linked linked(Triangles triangles) {
  check_triangles(triangles);
  Linked linked{{}, pair_halfedges(triangles)};
  std::vector<glm::dvec3> copies_mm;
  const std::vector<Mesh::VertexHandle> vertex = place_corners(triangles, linked.opposite, copies_mm);
  if (!copies_mm.empty()) {
    for (std::size_t c = 0; c < vertex.size(); ++c)
      triangles.faces[c / 3][c % 3] = static_cast<std::uint32_t>(vertex[c].idx());
    triangles.points_mm.insert(triangles.points_mm.end(), copies_mm.begin(), copies_mm.end());
  }
  linked.triangles = std::move(triangles);
  return linked;
}

Triangles triangles_of(const Mesh& mesh) {
  Triangles triangles;
  triangles.points_mm.resize(mesh.n_vertices());
  triangles.faces.resize(mesh.n_faces());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.n_vertices(), 4096), [&](const auto& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v) {
      assert(!mesh.status(Mesh::VertexHandle(static_cast<int>(v))).deleted());
      const Mesh::Point& p = mesh.point(Mesh::VertexHandle(static_cast<int>(v)));
      triangles.points_mm[v] = {p[0], p[1], p[2]};
    }
  });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.n_faces(), 4096), [&](const auto& range) {
    for (std::size_t f = range.begin(); f != range.end(); ++f) {
      const Mesh::FaceHandle face(static_cast<int>(f));
      assert(!mesh.status(face).deleted());
      const Mesh::HalfedgeHandle h = mesh.halfedge_handle(face);
      const auto number = [&](Mesh::HalfedgeHandle to) {
        return static_cast<std::uint32_t>(mesh.to_vertex_handle(to).idx());
      };
      triangles.faces[f] = {number(mesh.prev_halfedge_handle(h)), number(h),
                            number(mesh.next_halfedge_handle(h))};
    }
  });
  return triangles;
}

}  // namespace octotomy::brep
