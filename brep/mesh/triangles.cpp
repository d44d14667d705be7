// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/triangles.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <tuple>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/sides.h"

// Writes the halfedge structure directly instead of by add_face(), which prints to standard error, depends on
// the order of triangles at vertices where several fans meet, and reports no reason on failure.
// 1 refuse invalid triangles; 2 pair sides by sorting those of each point; 3 separate the fans at each point;
// 4 write edges, faces and the loops along the boundary.

namespace octotomy::brep {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

[[noreturn]] void refuse(std::size_t face, const std::string& why, const std::string& advice) {
  throw Error(ErrorCode::Input, "triangle " + std::to_string(face) + " " + why + "; " + advice);
}

enum class Flaw { None, NoPoint, NotFinite, Repeated };
Flaw flaw_of(const Triangles& triangles, const std::array<std::uint32_t, 3>& face) {
  for (const std::uint32_t v : face) {
    if (v >= triangles.points_mm.size()) return Flaw::NoPoint;
    const glm::dvec3& p = triangles.points_mm[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return Flaw::NotFinite;
  }
  return face[0] == face[1] || face[1] == face[2] || face[2] == face[0] ? Flaw::Repeated : Flaw::None;
}

void check_triangles(const Triangles& triangles) {
  // Corners, three per triangle, are numbered in 32 bits.
  if (triangles.faces.size() >= none / 3 || triangles.points_mm.size() >= none / 2)
    throw Error(ErrorCode::Resource, "a mesh of " + std::to_string(triangles.faces.size()) +
                                         " triangles is more than 32-bit numbers hold; reduce it first");
  const std::size_t count = triangles.faces.size();
  const auto& faces = triangles.faces;
  const std::size_t first = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, 4096), count,
      [&](const tbb::blocked_range<std::size_t>& range, std::size_t found) {
        for (std::size_t f = range.begin(); f < std::min(found, range.end()); ++f)
          if (flaw_of(triangles, faces[f]) != Flaw::None) found = f;
        return found;
      },
      [](std::size_t one, std::size_t other) { return std::min(one, other); });
  if (first == count) return;
  const auto no_point = std::find_if(faces[first].begin(), faces[first].end(),
                                     [&](std::uint32_t v) { return v >= triangles.points_mm.size(); });
  switch (flaw_of(triangles, faces[first])) {
    case Flaw::NoPoint:
      refuse(first,
             "refers to point " + std::to_string(*no_point) + " of " +
                 std::to_string(triangles.points_mm.size()),
             "the file or generator is at fault");
    case Flaw::NotFinite:
      refuse(first, "has a point that is not finite", "the file or generator is at fault");
    default:
      refuse(first, "repeats a point", "remove triangles without area first");
  }
}

/// For each side, the one along the same edge in the opposite direction, or none.
std::vector<std::uint32_t> pair_sides(const Triangles& triangles) {
  std::vector<std::uint32_t> opposite;
  std::optional<SidesOfPoints> sides;
  tbb::parallel_invoke([&] { opposite.assign(3 * triangles.faces.size(), none); },
                       [&] { sides.emplace(triangles); });
  // The first invalid triangle, and the edge at which it is invalid.
  using Offence = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, bool>;
  constexpr Offence no_offence{none, none, none, false};
  tbb::enumerable_thread_specific<Offence> found(no_offence);
  each_edge_in_parallel(*sides, [&](const Side* begin, const Side* end) {
    if (end - begin == 1) return;
    const bool same_way = begin[0].upward == begin[1].upward;
    if (same_way || end - begin > 2) {
      const std::uint32_t culprit = (same_way ? begin[1] : begin[2]).corner / 3;
      found.local() = std::min(found.local(), Offence(culprit, begin->low, begin->high, !same_way));
      return;
    }
    opposite[begin[0].corner] = begin[1].corner;
    opposite[begin[1].corner] = begin[0].corner;
  });
  const auto [offender, low, high, too_many] =
      found.combine([](const Offence& a, const Offence& b) { return std::min(a, b); });
  if (offender != none)
    refuse(offender,
           too_many ? "is the third along one of its edges" : "runs along an edge the same way as another",
           "check the health of the triangles and repair or separate them first");
  return opposite;
}

/// Whether the triangles around each point form a single closed fan.
bool has_closed_fans_alone(const Linked& linked) {
  std::atomic<bool> alone = true;
  PointShares(linked.triangles).visit([&](std::uint32_t first, std::uint32_t end, const auto& each) {
    // By point: 0 before its first corner was visited. Then 1 plus the number of corners that are still to
    // come of the fan to which the first corner belongs.
    std::vector<std::uint32_t> to_come(end - first, 0);
    each([&](std::uint32_t f) {
      if (!alone.load(std::memory_order_relaxed)) return;
      for (std::uint32_t corner = 3 * f; corner < 3 * f + 3; ++corner) {
        const std::uint32_t point = linked.from(corner) - first;
        if (point >= end - first) continue;
        std::uint32_t& count = to_come[point];
        if (count == 0) {
          count = 1;
          std::uint32_t turning = corner;
          do {
            ++count;
            turning = linked.opposite[turning] == none ? none : next_corner(linked.opposite[turning]);
          } while (turning != none && turning != corner);
          if (turning == none) count = 1;
        }
        if (count == 1) alone = false;  // a corner at a boundary or of another fan
        --count;
      }
    });
  });
  return alone;
}

/// Creates a copy of the point for each further fan around it, so that each point has one fan. The fan with
/// the first corner keeps the point.
void separate_fans(Linked& linked) {
  Triangles& triangles = linked.triangles;
  std::vector<std::uint8_t> has_fan(triangles.points_mm.size(), 0);
  std::uint32_t vertex = 0;
  each_fan(
      linked.opposite,
      [&](std::uint32_t corner) {
        vertex = linked.from(corner);
        if (has_fan[vertex]) {
          triangles.points_mm.push_back(glm::dvec3(triangles.points_mm[vertex]));
          vertex = static_cast<std::uint32_t>(triangles.points_mm.size() - 1);
        } else {
          has_fan[vertex] = 1;
        }
      },
      [&](std::uint32_t corner) { triangles.faces[corner / 3][corner % 3] = vertex; });
}

}  // namespace

bool Linked::is_closed() const {
  return std::find(opposite.begin(), opposite.end(), none) == opposite.end();
}

void check_joins(const Triangles& triangles) {
  check_triangles(triangles);
  pair_sides(triangles);
}

Linked linked(Triangles triangles) {
  check_triangles(triangles);
  std::vector<std::uint32_t> opposite = pair_sides(triangles);
  Linked linked{std::move(triangles), std::move(opposite)};
  if (!has_closed_fans_alone(linked)) separate_fans(linked);
  return linked;
}

Mesh mesh_of(const Triangles& triangles) {
  return mesh_of(linked(triangles));
}

Mesh mesh_of(const Linked& linked) {
  const Triangles& triangles = linked.triangles;
  const std::vector<std::uint32_t>& opposite = linked.opposite;
  const auto vertex = [](std::uint32_t point) { return Mesh::VertexHandle(static_cast<int>(point)); };

  // Edges are numbered in order of their first sides; the halfedge of its first side is the edge's first
  // halfedge.
  std::vector<Mesh::HalfedgeHandle> halfedge(opposite.size());
  int edge_count = 0;
  for (std::uint32_t c = 0; c < opposite.size(); ++c)
    halfedge[c] = opposite[c] < c ? Mesh::HalfedgeHandle(halfedge[opposite[c]].idx() + 1)
                                  : Mesh::HalfedgeHandle(2 * edge_count++);

  Mesh mesh;
  mesh.resize(triangles.points_mm.size(), static_cast<std::size_t>(edge_count), triangles.faces.size());
  for (std::uint32_t v = 0; v < triangles.points_mm.size(); ++v) {
    const glm::dvec3& p = triangles.points_mm[v];
    mesh.set_point(vertex(v), Mesh::Point(p.x, p.y, p.z));
  }
  std::vector<Mesh::HalfedgeHandle> boundary;
  for (std::uint32_t c = 0; c < opposite.size(); ++c) {
    const Mesh::FaceHandle face(static_cast<int>(c / 3));
    if (c % 3 == 0) mesh.set_halfedge_handle(face, halfedge[c]);
    mesh.set_vertex_handle(halfedge[c], vertex(linked.to(c)));
    mesh.set_face_handle(halfedge[c], face);
    mesh.set_next_halfedge_handle(halfedge[c], halfedge[next_corner(c)]);
    mesh.set_halfedge_handle(vertex(linked.from(c)), halfedge[c]);
    if (opposite[c] != none) continue;
    boundary.push_back(mesh.opposite_halfedge_handle(halfedge[c]));
    mesh.set_vertex_handle(boundary.back(), vertex(linked.from(c)));
  }

  // Every fan has its own vertex, so at most one boundary halfedge leaves each vertex. The vertex must point
  // to it.
  for (const Mesh::HalfedgeHandle outside : boundary) {
    mesh.set_boundary(outside);
    mesh.set_halfedge_handle(mesh.from_vertex_handle(outside), outside);
  }
  for (const Mesh::HalfedgeHandle outside : boundary)
    mesh.set_next_halfedge_handle(outside, mesh.halfedge_handle(mesh.to_vertex_handle(outside)));
  return mesh;
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

Linked linked_of(const Mesh& mesh) {
  Linked linked{triangles_of(mesh), std::vector<std::uint32_t>(3 * mesh.n_faces(), none)};
  // For each halfedge, its side.
  std::vector<std::uint32_t> side_of(mesh.n_halfedges(), none);
  const auto each_side = [&](const auto& visit) {
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(mesh.n_faces()), 4096),
                      [&](const auto& range) {
                        for (std::uint32_t f = range.begin(); f != range.end(); ++f) {
                          auto h = mesh.halfedge_handle(Mesh::FaceHandle(static_cast<int>(f)));
                          for (std::uint32_t k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
                            visit(3 * f + k, h);
                        }
                      });
  };
  each_side(
      [&](std::uint32_t side, Mesh::HalfedgeHandle h) { side_of[static_cast<std::size_t>(h.idx())] = side; });
  each_side([&](std::uint32_t side, Mesh::HalfedgeHandle h) {
    linked.opposite[side] = side_of[static_cast<std::size_t>(mesh.opposite_halfedge_handle(h).idx())];
  });
  return linked;
}

}  // namespace octotomy::brep
