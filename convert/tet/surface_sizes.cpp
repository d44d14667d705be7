// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/surface_sizes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <queue>

// Grading is Dijkstra's algorithm: of the sizes that are not final yet, the smallest cannot be reduced by any
// other.

namespace octotomy::convert {
namespace {

/// Sizes below this share of the mean size are noise.
constexpr double least_share() {
  return 0.125;
}

double side_of_area(double area_mm2) {
  return std::sqrt(area_mm2 * 4.0 / std::sqrt(3.0));
}

using Waiting = std::pair<double, std::uint32_t>;
using Queue = std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>>;

double area_mm2(const MesherInput& surface, const std::array<std::uint32_t, 3>& triangle) {
  const auto& p = surface.points_mm;
  const auto& [a, b, c] = triangle;
  return 0.5 * glm::length(glm::cross(p[b] - p[a], p[c] - p[a]));
}

}  // namespace

double mean_side_mm(const MesherInput& surface) {
  double all_mm2 = 0.0;
  for (const auto& triangle : surface.triangles) all_mm2 += area_mm2(surface, triangle);
  return side_of_area(all_mm2 / static_cast<double>(surface.triangles.size()));
}

SurfaceSizes::SurfaceSizes(const MesherInput& surface, double grading, const SizeLimits& limits)
    : surface_(surface),
      grading_(grading),
      sizes_mm_(surface.points_mm.size()),
      first_(surface.points_mm.size() + 1, 0) {
  assert(!surface.triangles.empty() && grading > 0.0);
  assert(limits.most_mm.empty() || limits.most_mm.size() == surface.points_mm.size());
  std::vector<double> about_mm2(sizes_mm_.size(), 0.0);
  std::vector<std::uint32_t> triangles(sizes_mm_.size(), 0);
  for (const auto& triangle : surface.triangles) {
    const double own_mm2 = area_mm2(surface, triangle);
    for (const std::uint32_t v : triangle) {
      about_mm2[v] += own_mm2;
      ++triangles[v];
      first_[v + 1] += 2;
    }
  }
  const double mean_mm = limits.mean_mm.value_or(mean_side_mm(surface));
  for (std::size_t v = 0; v < sizes_mm_.size(); ++v) {
    sizes_mm_[v] =
        std::clamp(side_of_area(about_mm2[v] / std::max(triangles[v], 1u)), least_share() * mean_mm, mean_mm);
    if (!limits.most_mm.empty()) sizes_mm_[v] = std::min(sizes_mm_[v], limits.most_mm[v]);
    first_[v + 1] += first_[v];
  }
  beside_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (const auto& corners : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 1; j < 3; ++j) beside_[next[corners.at(i)]++] = corners.at((i + j) % 3);
  grade();
}

void SurfaceSizes::grade() {
  Queue waiting;
  for (std::uint32_t v = 0; v < sizes_mm_.size(); ++v) waiting.emplace(sizes_mm_[v], v);
  while (!waiting.empty()) {
    const auto [size_mm, v] = waiting.top();
    waiting.pop();
    if (size_mm > sizes_mm_[v]) continue;
    for (std::size_t i = first_[v]; i < first_[v + 1]; ++i) {
      const std::uint32_t w = beside_[i];
      const double most_mm = size_mm + grading_ * glm::distance(surface_.points_mm[v], surface_.points_mm[w]);
      if (!(most_mm < sizes_mm_[w])) continue;
      sizes_mm_[w] = most_mm;
      waiting.emplace(most_mm, w);
    }
  }
}

void SurfaceSizes::halve(const std::vector<std::uint32_t>& points) {
  for (const std::uint32_t v : points) sizes_mm_[v] *= 0.5;
  grade();
}

void SurfaceSizes::scale(double by) {
  for (double& size_mm : sizes_mm_) size_mm *= by;
}

std::vector<std::uint32_t> SurfaceSizes::thinned(const std::vector<std::uint32_t>& points) const {
  std::vector<std::uint32_t> kept;
  std::vector<bool> covered(sizes_mm_.size(), false);
  for (const std::uint32_t from : points) {
    if (covered[from]) continue;
    kept.push_back(from);
    const double reach_mm = 0.5 * sizes_mm_[from];
    Queue waiting;
    waiting.emplace(0.0, from);
    covered[from] = true;
    while (!waiting.empty()) {
      const auto [way_mm, v] = waiting.top();
      waiting.pop();
      for (std::size_t i = first_[v]; i < first_[v + 1]; ++i) {
        const std::uint32_t w = beside_[i];
        const double on_mm = way_mm + glm::distance(surface_.points_mm[v], surface_.points_mm[w]);
        if (covered[w] || on_mm > reach_mm) continue;
        covered[w] = true;
        waiting.emplace(on_mm, w);
      }
    }
  }
  return kept;
}

}  // namespace octotomy::convert
