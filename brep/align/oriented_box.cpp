// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/oriented_box.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/optimal_bounding_box.h>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "brep/align/forward_axis.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

std::vector<Kernel::Point_3> points_of(const Mesh& mesh) {
  std::vector<Kernel::Point_3> points;
  for (const auto v : mesh.vertices())
    if (!mesh.is_isolated(v)) points.emplace_back(mesh.point(v)[0], mesh.point(v)[1], mesh.point(v)[2]);
  return points;
}

}  // namespace

OrientedBox oriented_box(const Mesh& mesh) {
  const std::vector<Kernel::Point_3> points = points_of(mesh);
  if (points.empty()) throw InvalidInput("oriented_box: there are no triangles for a box");
  std::array<Kernel::Point_3, 8> corners;
  // Uses a fixed seed, because the default generator would continue from the previous call.
  CGAL::oriented_bounding_box(points, corners, CGAL::parameters::use_convex_hull(true).random_seed(1));

  // The neighbours of corner 0 are corners 1, 3 and 5.
  const auto at = [&](std::size_t i) { return glm::dvec3(corners[i].x(), corners[i].y(), corners[i].z()); };
  std::array<glm::dvec3, 3> edges = {at(1) - at(0), at(3) - at(0), at(5) - at(0)};
  std::stable_sort(edges.begin(), edges.end(),
                   [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a) > glm::length(b); });
  OrientedBox box;
  box.centre_mm = at(0) + 0.5 * (edges[0] + edges[1] + edges[2]);
  for (int k = 0; k < 3; ++k) box.edges_mm[k] = glm::length(edges[static_cast<std::size_t>(k)]);
  // A flat box keeps its two axes.
  if (!(box.edges_mm.y > 0.0))
    throw InvalidInput("oriented_box: all points lie in one line, so a box has no axes");
  box.axes[0] = forward(edges[0] / box.edges_mm.x);
  box.axes[1] = forward(edges[1] / box.edges_mm.y);
  box.axes[2] = glm::normalize(glm::cross(box.axes[0], box.axes[1]));
  return box;
}

}  // namespace octotomy::brep
