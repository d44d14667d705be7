// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/winding_threshold.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tbb/parallel_for.h>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/distance.h"
#include "voxel/space/error.h"

// Passes 1 and 3 of winding_number.cpp.

namespace octotomy::convert {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

struct RimEdge {
  std::uint32_t from = 0, to = 0;
  int excess = 1;  ///< triangles along it from -> to, less those to -> from
};

/// Pass 1, in ascending order.
std::vector<RimEdge> rim_of(const brep::Triangles& surface) {
  std::vector<std::pair<std::uint64_t, int>> ways;
  ways.reserve(3 * surface.faces.size());
  for (const auto& face : surface.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = face[i];
      const std::uint32_t to = face[(i + 1) % 3];
      if (from != to)
        ways.emplace_back((std::uint64_t{std::min(from, to)} << 32) | std::max(from, to), from < to ? 1 : -1);
    }
  std::sort(ways.begin(), ways.end());
  std::vector<RimEdge> rim;
  for (std::size_t i = 0; i < ways.size();) {
    int excess = 0;
    std::size_t end = i;
    for (; end < ways.size() && ways[end].first == ways[i].first; ++end) excess += ways[end].second;
    if (excess != 0)
      rim.push_back({static_cast<std::uint32_t>(ways[i].first >> 32),
                     static_cast<std::uint32_t>(ways[i].first), excess});
    i = end;
  }
  return rim;
}

/// Offset of an apex from its rim's middle, in voxel edges. Not a simple fraction, so that the cap of a flat
/// hole does not lie in a plane of voxel centres.
constexpr glm::dvec3 apex_offset_voxels{0.2718281828, 0.3141592653, 0.1414213562};

/// Whether some plane certainly separates a triangle from a cube. Source: Akenine-Moller, "Fast 3D
/// triangle-box overlap testing", Journal of Graphics Tools 6(1), 2001. Departure: a case that rounding
/// leaves undecided counts as not separated.
bool is_parted(const Corners& triangle, const glm::dvec3& middle, double half_side) {
  const Corners from_middle{triangle[0] - middle, triangle[1] - middle, triangle[2] - middle};
  double farthest = 0.0;
  for (const glm::dvec3& corner : from_middle)
    farthest = std::max({farthest, std::abs(corner.x), std::abs(corner.y), std::abs(corner.z)});
  const auto parts = [&](const glm::dvec3& normal) {
    const double along_x = glm::dot(normal, from_middle[0]);
    const double along_y = glm::dot(normal, from_middle[1]);
    const double along_z = glm::dot(normal, from_middle[2]);
    const auto [low, high] = std::minmax({along_x, along_y, along_z});
    const double length = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    // The error of each product is five roundings, plus the rounding of the corners.
    const double unsure = 16.0 * std::numeric_limits<double>::epsilon() * length * (farthest + half_side);
    return low > half_side * length + unsure || high < -half_side * length - unsure;
  };
  const glm::dvec3 first_edge = triangle[1] - triangle[0];
  if (parts(glm::cross(first_edge, triangle[2] - triangle[0]))) return true;
  for (std::size_t i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 unit(0.0);
      unit[axis] = 1.0;
      if (parts(glm::cross(unit, triangle[(i + 1) % 3] - triangle[i]))) return true;
    }
  return false;
}

ThresholdNode node_of(const voxel::Universe& universe, const WindingThreshold& threshold,
                      const std::stop_token& stop, const Cube& cube) {
  ThresholdNode node;
  if (glm::any(glm::greaterThanEqual(cube.origin, glm::ivec3(universe.side())))) {
    node.number = 1;  // the cube has no voxel
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

double covered_share(const std::array<glm::dvec3, 3>& triangle, const glm::dvec3& p) {
  const glm::dvec3 a = triangle[0] - p;
  const glm::dvec3 b = triangle[1] - p;
  const glm::dvec3 c = triangle[2] - p;
  const double la = glm::length(a);
  const double lb = glm::length(b);
  const double lc = glm::length(c);
  const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return std::atan2(glm::dot(a, glm::cross(b, c)), below) / (2.0 * std::numbers::pi);
}

/// Closes each connected part of the rim by a cone whose apex is near the middle of its edges.
Cap cap_of(const voxel::Universe& universe, const brep::Triangles& surface) {
  const std::vector<RimEdge> rim = rim_of(surface);
  brep::DisjointSets rims(surface.points_mm.size());
  for (const RimEdge& edge : rim) rims.join(edge.from, edge.to);
  std::map<std::uint32_t, std::pair<glm::dvec3, double>> sums;
  for (const RimEdge& edge : rim) {
    auto& [sum, count] = sums[rims.set_of(edge.from)];
    sum += surface.points_mm[edge.from] + surface.points_mm[edge.to];
    count += 2.0;
  }
  Cap cap;
  for (const RimEdge& edge : rim) {
    const auto& [sum, count] = sums[rims.set_of(edge.from)];
    const glm::dvec3 apex = sum / count + glm::dmat3(universe.lps_from_voxel) * apex_offset_voxels;
    const glm::dvec3& from = surface.points_mm[edge.from];
    const glm::dvec3& to = surface.points_mm[edge.to];
    if (from == to) continue;  // covers nothing
    for (int i = 0; i < std::abs(edge.excess); ++i) {
      cap.triangles.push_back(edge.excess > 0 ? Triangle{to, from, apex} : Triangle{from, to, apex});
      cap.edges.push_back({from, to});
    }
  }
  return cap;
}

WindingThreshold::WindingThreshold(const voxel::Universe& universe, const Cap& cap)
    : lattice_(universe.lattice()), cap_(cap) {
  for (const Triangle& triangle : cap.triangles) {
    const Corners& corners = in_voxels_.emplace_back(
        Corners{lattice_.voxel(triangle[0]), lattice_.voxel(triangle[1]), lattice_.voxel(triangle[2])});
    bounds_.emplace_back(glm::min(corners[0], glm::min(corners[1], corners[2])),
                         glm::max(corners[0], glm::max(corners[1], corners[2])));
  }
}

std::optional<int> WindingThreshold::in_cube(const Cube& cube) const {
  if (cube.side > 1 && meets_cap(cube)) return std::nullopt;
  const glm::dvec3 middle_mm = lattice_.lps_mm(glm::dvec3(cube.origin) + 0.5 * (cube.side - 1));
  double share = 0.0;
  for (const Triangle& triangle : cap_.triangles) share += covered_share(triangle, middle_mm);
  if (!std::isfinite(share))
    throw voxel::Error(voxel::ErrorCode::Geometry,
                       "a hole's rim lies too far away for it to be closed: remove points beyond 1e100 mm");
  if (cube.side > 1 && may_change(cube, middle_mm, share)) return std::nullopt;
  return static_cast<int>(std::floor(share + 0.5)) + 1;
}

bool WindingThreshold::meets_cap(const Cube& cube) const {
  const glm::dvec3 low(cube.origin);
  const glm::dvec3 high = low + static_cast<double>(cube.side - 1);
  for (std::size_t t = 0; t < bounds_.size(); ++t) {
    const auto& [cap_low, cap_high] = bounds_[t];
    if (glm::all(glm::lessThanEqual(cap_low, high)) && glm::all(glm::lessThanEqual(low, cap_high)) &&
        !is_parted(in_voxels_[t], 0.5 * (low + high), 0.5 * (cube.side - 1)))
      return true;
  }
  return false;
}

/// Whether w may pass a threshold between the middle and another voxel. The integral of 1 / r^2 along an edge
/// is the angle that the edge subtends, divided by the distance of its line. With D the distance of the edge
/// itself, no r shrinks by more than the factor 1 - reach / D.
bool WindingThreshold::may_change(const Cube& cube, const glm::dvec3& middle_mm, double share) const {
  const glm::dvec3 spacing = lattice_.spacing_mm();
  // A lattice may be oblique, but no diagonal is longer than the three edges together.
  const double reach = 0.5 * (cube.side - 1) * (spacing.x + spacing.y + spacing.z);
  const double room = std::abs(share + 0.5 - std::round(share + 0.5));
  double change = 0.0;
  for (const std::array<glm::dvec3, 2>& edge : cap_.edges) {
    const double distance = std::sqrt(brep::squared_distance_to_segment(middle_mm, edge[0], edge[1]));
    if (!(distance > reach)) return true;
    const glm::dvec3 from = edge[0] - middle_mm, to = edge[1] - middle_mm;
    const double length = glm::length(to - from);
    const double twice_area = glm::length(glm::cross(from, to));
    double integral = length / (distance * distance);
    if (twice_area > 0.0)
      integral = std::min(integral, std::atan2(twice_area, glm::dot(from, to)) * length / twice_area);
    const double nearer = distance / (distance - reach);
    change += integral * nearer * nearer * reach / (4.0 * std::numbers::pi);
    if (change >= room) return true;
  }
  return false;
}

ThresholdNode threshold_tree(const voxel::Universe& universe, const WindingThreshold& threshold,
                             const std::stop_token& stop) {
  const int side = 1 << (2 * voxel::root_height(universe.depth));
  return node_of(universe, threshold, stop, {glm::ivec3(0), side});
}

}  // namespace octotomy::convert
