// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/align/oriented_box.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/convex_hull_3.h>
#include <CGAL/optimal_bounding_box.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
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

/// If the hull has more points than this, the search uses those that lie furthest in `most_points / 2`
/// directions and in the opposite ones. Every direction is within about 2 degrees of one of these directions.
/// The box is measured again over all points, so it holds all of them; on a rounded body its edges exceed the
/// shortest possible ones by less than 0.1 %.
constexpr std::size_t most_points = 4000;

glm::dvec3 as_vector(const Kernel::Point_3& p) {
  return {p.x(), p.y(), p.z()};
}

std::vector<Kernel::Point_3> furthest_points(const std::vector<Kernel::Point_3>& hull) {
  std::vector<std::size_t> chosen;
  const std::size_t directions = most_points / 2;
  for (std::size_t i = 0; i < directions; ++i) {
    // Directions along a spiral over half of the sphere; each represents an equal area.
    const double z = (static_cast<double>(i) + 0.5) / static_cast<double>(directions),
                 turn = static_cast<double>(i) * std::numbers::pi * (3.0 - std::sqrt(5.0)),
                 r = std::sqrt(1.0 - z * z);
    const glm::dvec3 along(r * std::cos(turn), r * std::sin(turn), z);
    std::size_t first = 0, last = 0;
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (std::size_t k = 0; k < hull.size(); ++k) {
      const double at = glm::dot(along, as_vector(hull[k]));
      if (at < low) low = at, first = k;
      if (at > high) high = at, last = k;
    }
    chosen.push_back(first);
    chosen.push_back(last);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  std::vector<Kernel::Point_3> points;
  for (const std::size_t k : chosen) points.push_back(hull[k]);
  return points;
}

/// Resizes the box, with the same axes, to hold all points.
void hold(const std::vector<Kernel::Point_3>& points, OrientedBox& box) {
  glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
  const glm::dmat3 frame_from_lps = glm::transpose(glm::dmat3(box.axes[0], box.axes[1], box.axes[2]));
  for (const Kernel::Point_3& p : points) {
    const glm::dvec3 at = frame_from_lps * (as_vector(p) - box.centre_mm);
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  box.centre_mm += glm::transpose(frame_from_lps) * (0.5 * (low + high));
  box.edges_mm = high - low;
}

/// Sorts axes and edges, the longest edge first.
void order(OrientedBox& box) {
  std::array<int, 3> by_length{0, 1, 2};
  std::stable_sort(by_length.begin(), by_length.end(),
                   [&](int p, int q) { return box.edges_mm[p] > box.edges_mm[q]; });
  const OrientedBox given = box;
  for (int k = 0; k < 3; ++k) {
    const auto from = static_cast<std::size_t>(by_length[static_cast<std::size_t>(k)]);
    box.axes[static_cast<std::size_t>(k)] = forward(given.axes[from]);
    box.edges_mm[k] = given.edges_mm[static_cast<int>(from)];
  }
  box.axes[2] = glm::normalize(glm::cross(box.axes[0], box.axes[1]));
}

}  // namespace

OrientedBox oriented_box(const Mesh& mesh) {
  std::vector<Kernel::Point_3> points = points_of(mesh), all;
  if (points.empty()) throw InvalidInput("oriented_box: the mesh has no triangles, so it has no box");
  bool is_hull = false;
  if (points.size() > most_points) {
    std::vector<Kernel::Point_3> hull;
    CGAL::extreme_points_3(points, std::back_inserter(hull));
    is_hull = true;
    if (hull.size() > most_points) {
      all = std::move(hull);
      points = furthest_points(all);
    } else {
      points = std::move(hull);
    }
  }
  std::array<Kernel::Point_3, 8> corners;
  // Uses a fixed seed, because the default generator would continue from the previous call.
  CGAL::oriented_bounding_box(points, corners, CGAL::parameters::use_convex_hull(!is_hull).random_seed(1));

  // The neighbours of corner 0 are corners 1, 3 and 5.
  const auto at = [&](std::size_t i) { return glm::dvec3(corners[i].x(), corners[i].y(), corners[i].z()); };
  std::array<glm::dvec3, 3> edges = {at(1) - at(0), at(3) - at(0), at(5) - at(0)};
  std::stable_sort(edges.begin(), edges.end(),
                   [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a) > glm::length(b); });
  OrientedBox box;
  box.centre_mm = at(0) + 0.5 * (edges[0] + edges[1] + edges[2]);
  for (int k = 0; k < 3; ++k) box.edges_mm[k] = glm::length(edges[static_cast<std::size_t>(k)]);
  // A flat box is valid: two edges suffice for three axes.
  if (!(box.edges_mm.y > 0.0))
    throw InvalidInput("oriented_box: all points lie on one line, so the axes of a box are undetermined");
  box.axes[0] = forward(edges[0] / box.edges_mm.x);
  box.axes[1] = forward(edges[1] / box.edges_mm.y);
  box.axes[2] = glm::normalize(glm::cross(box.axes[0], box.axes[1]));
  if (!all.empty()) {
    hold(all, box);
    order(box);
  }
  return box;
}

}  // namespace octotomy::brep
