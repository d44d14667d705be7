// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <vector>

#include "voxel/solid/operand.h"
#include "voxel/solid/operand_frame.h"
#include "voxel/space/vector_clones.h"

namespace octotomy::voxel {
namespace {

// Whether a segment meets a rectangle, by separating axes: the rectangle's two and the segment's normal.
bool meets_rectangle(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& centre,
                     const glm::dvec2& half) {
  const glm::dvec2 middle = 0.5 * (a + b) - centre;
  const glm::dvec2 arm = 0.5 * (b - a);
  if (std::abs(middle.x) > half.x + std::abs(arm.x) || std::abs(middle.y) > half.y + std::abs(arm.y))
    return false;
  const double across = std::abs(middle.x * arm.y - middle.y * arm.x);
  return across <= half.x * std::abs(arm.y) + half.y * std::abs(arm.x);
}

using Edge = std::array<glm::dvec2, 2>;

/// A rectangle of a view's millimetres that holds the voxels of a block.
struct Patch {
  glm::dvec2 centre, half;
};
Patch patch_of(const Linear& u, const Linear& v, const Cube& cube) {
  return {{u(cube.centre), v(cube.centre)}, {reach(u, cube.half), reach(v, cube.half)}};
}

/// Whether a ray from within the patch towards growing x may cross an edge.
bool within_reach(const Edge& edge, const Patch& patch) {
  const auto [a, b] = edge;
  return a.y != b.y && std::min(a.y, b.y) <= patch.centre.y + patch.half.y &&
         std::max(a.y, b.y) >= patch.centre.y - patch.half.y &&
         std::max(a.x, b.x) >= patch.centre.x - patch.half.x;
}

/// The edges of a region that decide about a patch: those within reach, of which a part of the patch needs no
/// others, and those that are level and meet it, which no ray crosses.
std::vector<Edge> edges_about(const Region& region, const Patch& patch) {
  std::vector<Edge> edges;
  for_each_edge(region.polygons_mm, [&](const glm::dvec2& a, const glm::dvec2& b) {
    if (within_reach({a, b}, patch) || (a.y == b.y && meets_rectangle(a, b, patch.centre, patch.half)))
      edges.push_back({a, b});
  });
  return edges;
}

Status status_of(const std::vector<Edge>& edges, const Patch& patch) {
  bool inside = false;
  for (const auto& [a, b] : edges) {
    if (meets_rectangle(a, b, patch.centre, patch.half)) return Status::Partial;
    inside ^= crosses_ray_from(a, b, patch.centre);
  }
  return inside ? Status::Full : Status::Empty;
}

/// A number for each voxel of a leaf.
using LeafValues = std::array<double, 64>;

OCTOTOMY_VECTOR_CLONES void values_in_leaf(const Linear& f, const glm::ivec3& origin, LeafValues& values) {
  // In Linear's order of summation, so that a voxel on an edge is on the same side for every caller.
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x)
        values[static_cast<std::size_t>(child_index(x, y, z))] = f.gradient.x * (origin.x + x) +
                                                                 f.gradient.y * (origin.y + y) +
                                                                 f.gradient.z * (origin.z + z) + f.constant;
}

/// Adds to each voxel's count whether the ray from it crosses the edge: crosses_ray_from() without a branch.
/// Precondition: the edge is not level.
OCTOTOMY_VECTOR_CLONES void count_crossings(const Edge& edge, const LeafValues& u, const LeafValues& v,
                                            LeafValues& counts) {
  const auto [a, b] = edge;
  const glm::dvec2 along = b - a;
  assert(along.y != 0.0);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double above_a = a.y > v[i] ? 1.0 : 0.0;
    const double above_b = b.y > v[i] ? 1.0 : 0.0;
    const double before = u[i] < along.x * (v[i] - a.y) / along.y + a.x ? 1.0 : 0.0;
    counts[i] += (above_a - above_b) * (above_a - above_b) * before;
  }
}

/// The voxels of odd counts.
std::uint64_t odd(const LeafValues& counts) {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) word |= (static_cast<std::uint64_t>(counts[i]) & 1) << i;
  return word;
}

}  // namespace

MaskOperand::MaskOperand(const RegionMask& mask, const glm::dmat4& still_from_target) {
  for (const Region& region : mask.regions)
    regions_.push_back({&region, along(still_from_target, region.view.right, 0.0),
                        along(still_from_target, region.view.up, 0.0)});
}

Cover MaskOperand::cover(const TargetBlock& block) const {
  Cover cover{all_children, all_children};
  for (const Projected& projected : regions_) {
    const Patch whole = patch_of(projected.u, projected.v, block.whole());
    const std::vector<Edge> edges = edges_about(*projected.region, whole);
    const Status status = status_of(edges, whole);
    if (status == Status::Empty) return {};
    if (status == Status::Full) continue;
    const glm::dvec2 half = patch_of(projected.u, projected.v, block.child(0)).half;
    cover =
        cover & cover_of_children(block, [&](const Cube& child) {
          return Meets::of(status_of(edges, {{projected.u(child.centre), projected.v(child.centre)}, half}));
        });
    if (cover.some == 0) break;
  }
  return cover;
}

void MaskOperand::words(const WantedLeaves& leaves) const {
  for_each_wanted(leaves, [&](const glm::ivec3&) { return all_children; });
  const TargetBlock block{leaves.origin, 4};
  for (const Projected& projected : regions_) {
    const std::vector<Edge> edges =
        edges_about(*projected.region, patch_of(projected.u, projected.v, block.whole()));
    const glm::dvec2 half = patch_of(projected.u, projected.v, block.child(0)).half;
    for (std::uint64_t rest = leaves.wanted; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      std::uint64_t& word = leaves.words[child];
      if (word == 0) continue;
      const glm::dvec3 centre = block.child(child).centre;
      const Patch patch{{projected.u(centre), projected.v(centre)}, half};
      // Only a leaf that an edge passes is asked voxel by voxel.
      const Status status = status_of(edges, patch);
      if (status == Status::Empty) word = 0;
      if (status != Status::Partial) continue;
      const glm::ivec3 origin = leaves.origin + 4 * child_place(child);
      LeafValues u, v, crossings{};
      values_in_leaf(projected.u, origin, u);
      values_in_leaf(projected.v, origin, v);
      for (const Edge& edge : edges)
        if (within_reach(edge, patch)) count_crossings(edge, u, v, crossings);
      word &= odd(crossings);
    }
  }
}

}  // namespace octotomy::voxel
