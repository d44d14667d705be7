// SPDX-License-Identifier: AGPL-3.0-or-later
// Pass 3 of winding_number.cpp. The winding number of the cap is a sum over a tree of its triangles, whose
// clusters are evaluated by moments where the remainder is small. All remainders are bounded and added. With
// d = (radius of the cluster + radius of the ball of points) / (distance of their centres), a series in d
// whose terms are at most (n + 1) d^n A / (4 pi distance^2) is cut off after n = 1, A the cluster's area.
// Source: Barill, Dickson, Schmidt, Levin, Jacobson, "Fast winding numbers for soups and clouds", SIGGRAPH
// 2018. Departure: the source bounds no error; here each decision is proven, or made by the exact sum.
#include "convert/voxel/winding_threshold.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <tbb/parallel_for.h>

#include "brep/mesh/distance.h"
#include "brep/mesh/halving.h"
#include "voxel/space/error.h"

namespace octotomy::convert {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

constexpr std::uint32_t leaf_size = 2;
constexpr double sphere = 4.0 * std::numbers::pi;

/// How much a triangle's covered share may differ between the middle and other points of a ball. The lesser
/// of two bounds: by its area, and by Biot and Savart's law for a current along its edges, whose integral of
/// 1 / r^2 along an edge is the angle that the edge subtends, divided by the distance of its line.
double change_bound(const Triangle& triangle, const glm::dvec3& middle_mm, double reach_mm) {
  const double distance =
      glm::distance(middle_mm, brep::nearest_of_triangle(middle_mm, triangle[0], triangle[1], triangle[2]));
  if (!(distance > reach_mm)) return 1.0;  // the ball may meet the triangle
  const double d = reach_mm / distance;
  const double area_mm2 = 0.5 * glm::length(glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
  const double by_area = area_mm2 / (sphere * distance * distance) * d * (2.0 - d) / ((1.0 - d) * (1.0 - d));
  double integral = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 from = triangle[i] - middle_mm, to = triangle[(i + 1) % 3] - middle_mm;
    const double squared = brep::squared_distance_to_segment(middle_mm, triangle[i], triangle[(i + 1) % 3]);
    const double length = glm::length(to - from), twice_area = glm::length(glm::cross(from, to));
    double of_edge = length / squared;
    if (twice_area > 0.0)
      of_edge = std::min(of_edge, std::atan2(twice_area, glm::dot(from, to)) * length / twice_area);
    // The factor by which a point of the edge may be nearer to other points of the ball than to its middle.
    const double nearer = 1.0 / (1.0 - reach_mm / std::sqrt(squared));
    integral += of_edge * nearer * nearer;
  }
  return std::min({1.0, by_area, integral * reach_mm / sphere});
}

ThresholdNode node_of(const voxel::Universe& universe, const WindingThreshold& threshold,
                      const std::stop_token& stop, const Cube& cube) {
  ThresholdNode node;
  if (glm::any(glm::greaterThanEqual(cube.origin, glm::ivec3(universe.side())))) {
    node.number = 1;  // the cube contains no voxel of the universe
    return node;
  }
  voxel::Progress{stop, {}}.at(0.0);
  node.number = threshold.in_cube(cube);
  if (node.number || cube.side == slab_layers) return node;
  node.children = std::make_unique<std::array<ThresholdNode, 64>>();
  tbb::parallel_for(0, 64, [&](int child) {
    const int side = cube.side / 4;
    (*node.children)[static_cast<std::size_t>(child)] =
        node_of(universe, threshold, stop, {cube.origin + side * voxel::child_place(child), side});
  });
  return node;
}

}  // namespace

double covered_share(const Triangle& triangle, const glm::dvec3& p) {
  const glm::dvec3 a = triangle[0] - p;
  const glm::dvec3 b = triangle[1] - p;
  const glm::dvec3 c = triangle[2] - p;
  const double la = glm::length(a);
  const double lb = glm::length(b);
  const double lc = glm::length(c);
  const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return std::atan2(glm::dot(a, glm::cross(b, c)), below) / (2.0 * std::numbers::pi);
}

WindingThreshold::WindingThreshold(const voxel::Universe& universe, std::vector<Triangle> cap)
    : lattice_(universe.lattice()), cap_(cap.size()) {
  if (cap.empty()) return;
  std::vector<brep::Centred> items;
  for (const Triangle& t : cap)
    items.push_back({(t[0] + t[1] + t[2]) / 3.0, static_cast<std::uint32_t>(items.size())});
  const auto count = static_cast<std::uint32_t>(cap.size());
  clusters_.resize(brep::halving_nodes(count, leaf_size));
  const auto leaf = [&](std::uint32_t self, std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) cap_[i] = cap[items[i].number];
    clusters_[self] = {brep::cluster_of(std::span(cap_).subspan(begin, end - begin)), begin, end - begin};
  };
  const auto inner = [&](std::uint32_t self, std::uint32_t second) {
    clusters_[self] = {brep::cluster_of(clusters_[self + 1], clusters_[second]), second, 0};
  };
  brep::halve(items, leaf_size, leaf, inner, 0, 0, count);
}

std::optional<int> WindingThreshold::in_cube(const Cube& cube) const {
  if (clusters_.empty()) return 1;
  const double half = 0.5 * (cube.side - 1);
  const glm::dvec3 middle_mm = lattice_.lps_mm(glm::dvec3(cube.origin) + half);
  double reach_mm = 0.0;  // to the farthest of the cube's corners
  for (int corner = 0; corner < 4 && cube.side > 1; ++corner)
    reach_mm = std::max(reach_mm,
                        glm::distance(middle_mm, lattice_.lps_mm(glm::dvec3(cube.origin) + half +
                                                                 half * glm::dvec3(corner & 1 ? 1 : -1,
                                                                                   corner & 2 ? 1 : -1, 1))));
  // A voxel that is not decided by an estimate is decided by the exact sum.
  for (const double tolerance : {0.1, 0.01, 1e-4, 0.0}) {
    const Estimate share = estimate(middle_mm, reach_mm, tolerance);
    if (!std::isfinite(share.middle))
      throw voxel::Error(voxel::ErrorCode::Geometry,
                         "a hole's rim lies too far away for it to be closed: remove points beyond 1e100 mm");
    const double room = std::abs(share.middle + 0.5 - std::round(share.middle + 0.5));
    const double change = glm::length(share.slope) * reach_mm + share.error;
    if (change < room || tolerance == 0.0) return static_cast<int>(std::floor(share.middle + 0.5)) + 1;
    if (cube.side > 1) return std::nullopt;
  }
  return std::nullopt;
}

/// Sums a cluster as one term if its remainder is at most the larger of `tolerance` / 100 and `tolerance`
/// times the cluster's share of the cap's area; otherwise its children, or its triangles one by one. Stops if
/// the error exceeds 1/2: such an estimate decides nothing.
WindingThreshold::Estimate WindingThreshold::estimate(const glm::dvec3& centre_mm, double reach_mm,
                                                      double tolerance) const {
  Estimate sum;
  std::array<std::uint32_t, 64> waiting;
  std::size_t top = 0;
  waiting[top++] = 0;
  while (top > 0 && !(sum.error > 0.5)) {
    const std::uint32_t index = waiting[--top];
    const Cluster& cluster = clusters_[index];
    const double distance = glm::distance(cluster.centre_mm, centre_mm);
    const double d = (cluster.radius_mm + reach_mm) / distance;
    if (d < 1.0) {
      const double remainder = cluster.area_mm2 / (sphere * distance * distance) * d * d * (3.0 - 2.0 * d) /
                               ((1.0 - d) * (1.0 - d));
      if (remainder <= tolerance * std::max(0.01, cluster.area_mm2 / clusters_[0].area_mm2)) {
        add(cluster, centre_mm, sum);
        sum.error += remainder;
        continue;
      }
    }
    if (cluster.count > 0) {
      for (std::uint32_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
        sum.middle += covered_share(cap_[i], centre_mm);
        if (reach_mm > 0.0) sum.error += change_bound(cap_[i], centre_mm, reach_mm);
      }
      continue;
    }
    // Evaluates the nearer child first: it may show that the ball must be divided.
    std::array<std::uint32_t, 2> children{cluster.first, index + 1};
    const auto gap = [&](std::uint32_t child) {
      return glm::distance(clusters_[child].centre_mm, centre_mm) - clusters_[child].radius_mm;
    };
    if (gap(children[0]) < gap(children[1])) std::swap(children[0], children[1]);
    waiting[top++] = children[0];
    waiting[top++] = children[1];
  }
  return sum;
}

/// The terms n = 0 and 1 of the gradient of 1 / r, in the places of triangles and in that of the point.
void WindingThreshold::add(const Cluster& cluster, const glm::dvec3& centre_mm, Estimate& sum) const {
  const glm::dvec3 r = cluster.centre_mm - centre_mm;
  const double by_r2 = 1.0 / glm::dot(r, r), by_r3 = by_r2 * std::sqrt(by_r2) / sphere;
  const double along = glm::dot(cluster.normal, r);
  const double trace = cluster.moment[0][0] + cluster.moment[1][1] + cluster.moment[2][2];
  sum.middle += by_r3 * (along + trace - 3.0 * by_r2 * glm::dot(r, cluster.moment * r));
  sum.slope += by_r3 * (3.0 * by_r2 * along * r - cluster.normal);
}

ThresholdNode threshold_tree(const voxel::Universe& universe, const WindingThreshold& threshold,
                             const std::stop_token& stop) {
  const int side = 1 << (2 * voxel::root_height(universe.depth));
  return node_of(universe, threshold, stop, {glm::ivec3(0), side});
}

}  // namespace octotomy::convert
