// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/surface_error.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <tbb/parallel_for.h>

namespace octotomy::brep {
namespace {

/// The sides of triangles, each once, the lower end first.
std::vector<std::array<std::uint32_t, 2>> sides_of(const Triangles& surface) {
  std::vector<std::array<std::uint32_t, 2>> sides;
  sides.reserve(3 * surface.faces.size());
  for (const auto& [a, b, c] : surface.faces)
    for (const auto& [from, to] : {std::array{a, b}, std::array{b, c}, std::array{c, a}})
      sides.push_back({std::min(from, to), std::max(from, to)});
  std::sort(sides.begin(), sides.end());
  sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
  return sides;
}

/// Points spread over a face, at most `spacing_mm` apart along its sides; corners left out, as they are
/// points of the given surface.
void spread(const Triangles& surface, std::uint32_t face, double spacing_mm, std::vector<glm::dvec3>& points,
            std::vector<std::uint32_t>& face_of) {
  constexpr int most = 256;
  const auto& [a, b, c] = surface.faces[face];
  const glm::dvec3 &p = surface.points_mm[a], &q = surface.points_mm[b], &r = surface.points_mm[c];
  const double longest_mm = std::max({glm::distance(p, q), glm::distance(q, r), glm::distance(r, p)});
  const int steps = std::clamp(static_cast<int>(std::ceil(longest_mm / spacing_mm)), 2, most);
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j) {
      if (i == steps || j == steps || (i == 0 && j == 0)) continue;
      points.push_back(p + (static_cast<double>(i) * (q - p) + static_cast<double>(j) * (r - p)) /
                               static_cast<double>(steps));
      face_of.push_back(face);
    }
}

struct Nearest {
  double distance_mm = 0.0;
  std::uint32_t face = 0;  ///< beyond the limit
};

std::vector<Nearest> nearest_of(const SurfaceTree& tree, const std::vector<glm::dvec3>& points,
                                double limit_mm, double enough_mm) {
  std::vector<Nearest> nearest(points.size());
  // Blocks are fixed, so that the start of each search does not depend on the threads.
  constexpr std::size_t block = 256;
  tbb::parallel_for(std::size_t{0}, (points.size() + block - 1) / block, [&](std::size_t b) {
    std::uint32_t triangle = 0;
    for (std::size_t i = b * block; i < std::min((b + 1) * block, points.size()); ++i) {
      nearest[i].distance_mm = tree.distance_mm(points[i], triangle, enough_mm);
      if (nearest[i].distance_mm > limit_mm) nearest[i].face = tree.foot(points[i], triangle).face;
    }
  });
  return nearest;
}

void sort_once(std::vector<std::uint32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace

FarPlaces far_places(const Triangles& given, const SurfaceTree& tree, const Triangles& coarse,
                     double limit_mm, double enough_mm) {
  assert(enough_mm <= limit_mm);
  FarPlaces far;
  const std::vector<std::array<std::uint32_t, 2>> sides = sides_of(given);
  double sum_mm = 0.0;
  for (const auto& [a, b] : sides) sum_mm += glm::distance(given.points_mm[a], given.points_mm[b]);
  const double spacing_mm = sum_mm / static_cast<double>(sides.size());

  // From the given surface to the coarse one.
  std::vector<std::uint32_t> used;
  for (const auto& face : given.faces) used.insert(used.end(), face.begin(), face.end());
  sort_once(used);
  std::vector<glm::dvec3> points;
  points.reserve(used.size() + sides.size());
  for (const std::uint32_t v : used) points.push_back(given.points_mm[v]);
  for (const auto& [a, b] : sides) points.push_back(0.5 * (given.points_mm[a] + given.points_mm[b]));
  const std::vector<Nearest> to_coarse = nearest_of(SurfaceTree(coarse), points, limit_mm, enough_mm);
  for (std::size_t i = 0; i < to_coarse.size(); ++i) {
    far.largest_mm = std::max(far.largest_mm, to_coarse[i].distance_mm);
    if (to_coarse[i].distance_mm <= limit_mm) continue;
    far.coarse_faces.push_back(to_coarse[i].face);
    if (i < used.size())
      far.given_points.push_back(used[i]);
    else
      far.given_points.insert(far.given_points.end(), sides[i - used.size()].begin(),
                              sides[i - used.size()].end());
  }

  // From the coarse surface to the given one.
  points.clear();
  std::vector<std::uint32_t> face_of;
  for (std::uint32_t f = 0; f < coarse.faces.size(); ++f) spread(coarse, f, spacing_mm, points, face_of);
  const std::vector<Nearest> to_given = nearest_of(tree, points, limit_mm, enough_mm);
  for (std::size_t i = 0; i < to_given.size(); ++i) {
    far.largest_mm = std::max(far.largest_mm, to_given[i].distance_mm);
    if (to_given[i].distance_mm <= limit_mm) continue;
    far.coarse_faces.push_back(face_of[i]);
    const auto& face = given.faces[to_given[i].face];
    far.given_points.insert(far.given_points.end(), face.begin(), face.end());
  }
  sort_once(far.given_points);
  sort_once(far.coarse_faces);
  return far;
}

}  // namespace octotomy::brep
