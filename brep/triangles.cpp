// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/triangles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

// The halfedge structure is written directly rather than by add_face, which prints to the standard error,
// depends on the order of the triangles at vertices where several fans meet, and cannot say what is wrong.
// 1 refuse triangles that are none; 2 pair halfedges by sorting; 3 tell the fans at each point apart;
// 4 write edges, faces and the loops along the boundary.

namespace octotomy::brep {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

[[noreturn]] void refuse(std::size_t face, const std::string& why, const std::string& advice) {
  throw std::runtime_error("triangle " + std::to_string(face) + " " + why + "; " + advice);
}

void check_triangles(const Triangles& triangles) {
  // Three corners of each triangle are numbered in 32 bits.
  if (triangles.faces.size() >= none / 3 || triangles.points_mm.size() >= none / 2)
    throw std::runtime_error("a mesh of " + std::to_string(triangles.faces.size()) +
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
  struct Side {
    std::uint32_t low, high, corner;
  };
  const auto corner_count = static_cast<std::uint32_t>(3 * triangles.faces.size());
  std::vector<Side> sides(corner_count);
  for (std::uint32_t c = 0; c < corner_count; ++c) {
    const std::uint32_t from = triangles.faces[c / 3][c % 3];
    const std::uint32_t to = triangles.faces[c / 3][(c + 1) % 3];
    sides[c] = {std::min(from, to), std::max(from, to), c};
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });

  std::vector<std::uint32_t> opposite(corner_count, none);
  std::uint32_t offender = none;
  bool too_many = false;
  for (std::size_t i = 0, j; i < sides.size(); i = j) {
    for (j = i + 1; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high;) ++j;
    if (j - i == 1) continue;
    const std::uint32_t first = sides[i].corner, second = sides[i + 1].corner;
    const bool same_way = triangles.faces[first / 3][first % 3] == triangles.faces[second / 3][second % 3];
    if (same_way || j - i > 2) {
      const std::uint32_t culprit = (same_way ? second : sides[i + 2].corner) / 3;
      if (culprit < offender) {
        offender = culprit;
        too_many = !same_way;
      }
      continue;
    }
    opposite[first] = second;
    opposite[second] = first;
  }
  if (offender != none)
    refuse(offender,
           too_many ? "is the third along one of its edges" : "runs along an edge the same way as another",
           "ask for the health of the triangles and repair or separate them first");
  return opposite;
}

/// Joins the corners that lie in one fan about a point.
class Fans {
 public:
  explicit Fans(std::size_t corner_count) : parent_(corner_count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t fan_of(std::uint32_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = fan_of(a);
    b = fan_of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Adds a vertex for each point and for each further fan about it; returns the vertex of each corner.
std::vector<Mesh::VertexHandle> add_vertices(const Triangles& triangles,
                                             const std::vector<std::uint32_t>& opposite, Mesh& mesh) {
  Fans fans(opposite.size());
  for (std::uint32_t c = 0; c < opposite.size(); ++c) {
    if (opposite[c] == none) continue;
    fans.join(c, next_corner(opposite[c]));
  }
  for (const glm::dvec3& p : triangles.points_mm) mesh.new_vertex(Mesh::Point(p.x, p.y, p.z));
  std::vector<std::uint32_t> first_fan(triangles.points_mm.size(), none);
  std::vector<Mesh::VertexHandle> of_fan(opposite.size()), of_corner(opposite.size());
  for (std::uint32_t c = 0; c < opposite.size(); ++c) {
    // The smallest corner of a fan is its name, so a fan is met by its name first.
    const std::uint32_t fan = fans.fan_of(c), v = triangles.faces[c / 3][c % 3];
    if (fan == c) {
      if (first_fan[v] == none) {
        first_fan[v] = fan;
        of_fan[fan] = Mesh::VertexHandle(static_cast<int>(v));
      } else {
        const glm::dvec3& p = triangles.points_mm[v];
        of_fan[fan] = mesh.new_vertex(Mesh::Point(p.x, p.y, p.z));
      }
    }
    of_corner[c] = of_fan[fan];
  }
  return of_corner;
}

}  // namespace

Mesh mesh_of(const Triangles& triangles) {
  check_triangles(triangles);
  const std::vector<std::uint32_t> opposite = pair_halfedges(triangles);
  Mesh mesh;
  mesh.reserve(triangles.points_mm.size(), opposite.size() / 2 + 1, triangles.faces.size());
  const std::vector<Mesh::VertexHandle> vertex = add_vertices(triangles, opposite, mesh);

  std::vector<Mesh::HalfedgeHandle> halfedge(opposite.size());
  for (std::uint32_t c = 0; c < opposite.size(); ++c) {
    if (opposite[c] != none && opposite[c] < c)
      halfedge[c] = mesh.opposite_halfedge_handle(halfedge[opposite[c]]);
    else
      halfedge[c] = mesh.new_edge(vertex[c], vertex[next_corner(c)]);
  }
  for (std::uint32_t c = 0; c < opposite.size(); c += 3) {
    const Mesh::FaceHandle face = mesh.new_face();
    mesh.set_halfedge_handle(face, halfedge[c]);
    for (std::uint32_t k = c; k < c + 3; ++k) {
      mesh.set_face_handle(halfedge[k], face);
      mesh.set_next_halfedge_handle(halfedge[k], halfedge[next_corner(k)]);
      mesh.set_halfedge_handle(vertex[k], halfedge[k]);
    }
  }

  // As every fan has its own vertex, at most one boundary halfedge leaves each; a vertex must point to it.
  std::vector<Mesh::HalfedgeHandle> boundary;
  for (std::uint32_t c = 0; c < opposite.size(); ++c) {
    if (opposite[c] != none) continue;
    const Mesh::HalfedgeHandle outside = mesh.opposite_halfedge_handle(halfedge[c]);
    mesh.set_boundary(outside);
    mesh.set_halfedge_handle(mesh.from_vertex_handle(outside), outside);
    boundary.push_back(outside);
  }
  for (const Mesh::HalfedgeHandle outside : boundary)
    mesh.set_next_halfedge_handle(outside, mesh.halfedge_handle(mesh.to_vertex_handle(outside)));
  return mesh;
}

Triangles triangles_of(const Mesh& mesh) {
  Triangles triangles;
  triangles.points_mm.reserve(mesh.n_vertices());
  triangles.faces.reserve(mesh.n_faces());
  for (const auto v : mesh.all_vertices()) {
    assert(!mesh.status(v).deleted());
    const Mesh::Point& p = mesh.point(v);
    triangles.points_mm.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : mesh.all_faces()) {
    assert(!mesh.status(f).deleted());
    const Mesh::HalfedgeHandle h = mesh.halfedge_handle(f);
    const auto index = [&](Mesh::HalfedgeHandle side) {
      return static_cast<std::uint32_t>(mesh.from_vertex_handle(side).idx());
    };
    triangles.faces.push_back(
        {index(h), index(mesh.next_halfedge_handle(h)), index(mesh.prev_halfedge_handle(h))});
  }
  return triangles;
}

}  // namespace octotomy::brep
