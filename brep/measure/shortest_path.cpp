// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 compute an upper bound of the length from a path along edges; 2 keep the triangles that a path of at most
// this length can touch; 3 search these exactly. Step 3 is the expensive one, and a path of a few centimetres
// cannot touch most of a head.
#include "brep/measure/shortest_path.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh_shortest_path.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <queue>
#include <stdexcept>
#include <utility>

#include "brep/mesh/components.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/surface_mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Surface>;
using Paths = CGAL::Surface_mesh_shortest_path<Traits>;

/// Converts a foot to CGAL's form. CGAL orders the weights by the face's corners, from the source of the
/// face's halfedge.
Paths::Face_location location_of(const Foot& foot, const Triangles& triangles, const Surface& surface) {
  const Surface::Face_index face(foot.face);
  const auto& corners = triangles.faces[foot.face];
  Paths::Barycentric_coordinates weights;
  auto h = surface.halfedge(face);
  for (std::size_t k = 0; k < 3; ++k, h = surface.next(h)) {
    const auto corner =
        std::find(corners.begin(), corners.end(), static_cast<std::uint32_t>(surface.source(h)));
    weights[k] = foot.weights[static_cast<int>(corner - corners.begin())];
  }
  return {face, weights};
}

double edge_mm(const Triangles& triangles, std::uint32_t v, std::uint32_t w) {
  return glm::distance(triangles.points_mm[v], triangles.points_mm[w]);
}

/// The length of the shortest path between two feet through their triangles' corners and along edges
/// (Dijkstra 1959): an upper bound for the shortest path. Infinite if there is none.
double length_along_edges(const Mesh& mesh, const Triangles& triangles, const Foot& from, const Foot& to) {
  using Entry = std::pair<double, std::uint32_t>;
  std::vector<double> lengths(triangles.points_mm.size(), std::numeric_limits<double>::infinity());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  const auto reach = [&](std::uint32_t v, double length) {
    if (length >= lengths[v]) return;
    lengths[v] = length;
    waiting.emplace(length, v);
  };
  for (const std::uint32_t v : triangles.faces[from.face])
    reach(v, glm::distance(from.p_mm, triangles.points_mm[v]));
  while (!waiting.empty()) {
    const auto [length, v] = waiting.top();
    waiting.pop();
    if (length > lengths[v]) continue;
    for (const auto neighbour : mesh.vv_range(Mesh::VertexHandle(static_cast<int>(v)))) {
      const auto w = static_cast<std::uint32_t>(neighbour.idx());
      reach(w, length + edge_mm(triangles, v, w));
    }
  }
  double shortest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t v : triangles.faces[to.face])
    shortest = std::min(shortest, lengths[v] + glm::distance(to.p_mm, triangles.points_mm[v]));
  return shortest;
}

/// The triangles that a path of at most this length can touch: for each point of the path, the distances to
/// both ends add up to at most the length, and no point of a triangle is further from a corner than the
/// longest side.
std::vector<std::uint32_t> within_reach(const Triangles& triangles, const Foot& from, const Foot& to,
                                        double length_mm) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < triangles.faces.size(); ++f) {
    const auto& face = triangles.faces[f];
    double least = std::numeric_limits<double>::infinity(), longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& p = triangles.points_mm[face[k]];
      least = std::min(least, glm::distance(p, from.p_mm) + glm::distance(p, to.p_mm));
      longest = std::max(longest, edge_mm(triangles, face[k], face[(k + 1) % 3]));
    }
    if (least - 2.0 * longest <= length_mm) faces.push_back(f);
  }
  return faces;
}

/// Refuses a point that is farther away than the size of the surface: it probably belongs to another surface.
void need_near(const glm::dvec3& asked_mm, const glm::dvec3& nearest_mm, const Triangles& triangles) {
  const Size size = size_of(triangles);
  const double off_mm = glm::distance(asked_mm, nearest_mm),
               extent_mm = glm::distance(size.low_mm, size.high_mm);
  if (off_mm <= extent_mm) return;
  throw Error(ErrorCode::Geometry, "shortest_path: the point (" + short_text(asked_mm.x) + ", " +
                                       short_text(asked_mm.y) + ", " + short_text(asked_mm.z) + ") mm lies " +
                                       short_text(off_mm) + " mm from the surface, which is only " +
                                       short_text(extent_mm) + " mm large: give a point near it");
}

}  // namespace

SurfacePath shortest_path(const Mesh& mesh, const glm::dvec3& from_mm, const glm::dvec3& to_mm) {
  if (mesh.n_faces() == 0) throw InvalidInput("shortest_path: the surface has no triangles");
  const Triangles all = triangles_of(mesh);
  const std::vector<Foot> ends = SurfaceTree(all).feet({from_mm, to_mm});
  need_near(from_mm, ends[0].p_mm, all);
  need_near(to_mm, ends[1].p_mm, all);
  const double bound_mm = length_along_edges(mesh, all, ends[0], ends[1]);
  if (!std::isfinite(bound_mm))
    throw Error(ErrorCode::Geometry, "shortest_path: the two points lie on separate pieces of the surface");
  // The margin covers the rounding of sums over thousands of edges.
  const Triangles triangles =
      triangles_of(part_of(mesh, within_reach(all, ends[0], ends[1], bound_mm * (1.0 + 0x1p-40))));
  const std::vector<Foot> feet = SurfaceTree(triangles).feet({ends[0].p_mm, ends[1].p_mm});
  const Surface surface = surface_mesh_of<Kernel::Point_3>(triangles);
  Paths paths(surface);
  paths.add_source_point(location_of(feet[0], triangles, surface));
  std::vector<Kernel::Point_3> points;
  const auto to = location_of(feet[1], triangles, surface);
  paths.shortest_path_points_to_source_points(to.first, to.second, std::back_inserter(points));
  SurfacePath path;
  std::reverse(points.begin(), points.end());
  for (const Kernel::Point_3& p : points) path.points_mm.emplace_back(p.x(), p.y(), p.z());
  for (std::size_t i = 1; i < path.points_mm.size(); ++i)
    path.length_mm += glm::distance(path.points_mm[i - 1], path.points_mm[i]);
  return path;
}

}  // namespace octotomy::brep
