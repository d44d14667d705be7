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

/// A rectangle in a view, in millimetres, that contains the projection of a cube.
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

/// The edges that decide which points of a patch are inside: edges that rays from the patch may cross, and
/// level edges that meet the patch, which no ray crosses. They also suffice for every part of the patch.
std::vector<Edge> edges_about(const EdgeTree& tree, const Patch& patch) {
  std::vector<Edge> edges = tree.edges_about(patch.centre - patch.half, patch.centre + patch.half);
  std::erase_if(edges, [&](const Edge& edge) {
    const auto& [a, b] = edge;
    return a.y == b.y ? !meets_rectangle(a, b, patch.centre, patch.half) : !within_reach(edge, patch);
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

/// One number for each child of a block, or for each voxel of a leaf.
using Values = std::array<double, 64>;

/// The values of f at the positions first + step * (x, y, z) of children or voxels.
OCTOTOMY_VECTOR_CLONES void values_at(const Linear& f, const glm::dvec3& first, double step, Values& values) {
  double along_x[4], along_y[4], along_z[4];
  for (int i = 0; i < 4; ++i) {
    along_x[i] = f.gradient.x * (first.x + i * step);
    along_y[i] = f.gradient.y * (first.y + i * step);
    along_z[i] = f.gradient.z * (first.z + i * step);
  }
  // Terms are added in the same order as in Linear, so that a voxel on an edge is on the same side for every
  // caller.
  double* to = values.data();
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y, to += 4)
      for (int x = 0; x < 4; ++x) to[x] = along_x[x] + along_y[y] + along_z[z] + f.constant;
}

/// Adds 1 to the count of each place from which the ray crosses the edge: crosses_ray_from() without a
/// branch. Precondition: the edge is not level.
OCTOTOMY_VECTOR_CLONES void count_crossings(const Edge& edge, const Values& u, const Values& v,
                                            Values& counts) {
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

/// Adds to the count of each place whose patch the edge meets: meets_rectangle() without a branch.
OCTOTOMY_VECTOR_CLONES void count_meetings(const Edge& edge, const glm::dvec2& half, const Values& u,
                                           const Values& v, Values& counts) {
  const auto [a, b] = edge;
  const glm::dvec2 middle = 0.5 * (a + b), arm = 0.5 * (b - a);
  const glm::dvec2 farthest = half + glm::abs(arm);
  const double farthest_across = half.x * std::abs(arm.y) + half.y * std::abs(arm.x);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double x = middle.x - u[i], y = middle.y - v[i];
    const double near_x = std::abs(x) > farthest.x ? 0.0 : 1.0;
    const double near_y = std::abs(y) > farthest.y ? 0.0 : 1.0;
    const double near_across = std::abs(x * arm.y - y * arm.x) <= farthest_across ? 1.0 : 0.0;
    counts[i] += near_x * near_y * near_across;
  }
}

/// A mask of the places whose count has at least one bit of `bits` set. Precondition: counts are below 2^31.
OCTOTOMY_VECTOR_CLONES std::uint64_t places_of(const Values& counts, std::int32_t bits) {
  std::array<std::uint8_t, 64> set;
  for (std::size_t i = 0; i < counts.size(); ++i)
    set[i] = (static_cast<std::int32_t>(counts[i]) & bits) != 0 ? 1 : 0;
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) word |= std::uint64_t{set[i]} << i;
  return word;
}

/// The status of the patches around the centres of a block's children, as status_of() computes it.
Cover cover_of_patches(const std::vector<Edge>& edges, const glm::dvec2& half, const Values& u,
                       const Values& v) {
  Values meetings{}, crossings{};
  for (const Edge& edge : edges) {
    count_meetings(edge, half, u, v, meetings);
    if (edge[0].y != edge[1].y) count_crossings(edge, u, v, crossings);
  }
  const std::uint64_t partial = places_of(meetings, -1), inside = places_of(crossings, 1);
  return {inside & ~partial, inside | partial};
}

}  // namespace

MaskOperand::MaskOperand(const RegionMask& mask, const glm::dmat4& still_from_target) {
  for (const Region& region : mask.regions)
    regions_.push_back({EdgeTree(region.polygons_mm), along(still_from_target, region.view.right, 0.0),
                        along(still_from_target, region.view.up, 0.0)});
}

Cover MaskOperand::cover(const TargetBlock& block) const {
  Cover cover{all_children, all_children};
  for (const Projected& projected : regions_) {
    const Patch whole = patch_of(projected.u, projected.v, block.whole());
    const std::vector<Edge> edges = edges_about(projected.edges, whole);
    const Status status = status_of(edges, whole);
    if (status == Status::Empty) return {};
    if (status == Status::Full) continue;
    const Cube first = block.child(0);
    Values u, v;
    values_at(projected.u, first.centre, block.child_side, u);
    values_at(projected.v, first.centre, block.child_side, v);
    cover = cover & cover_of_patches(edges, patch_of(projected.u, projected.v, first).half, u, v);
    if (cover.some == 0) break;
  }
  return cover;
}

void MaskOperand::words(const WantedLeaves& leaves) const {
  for_each_wanted(leaves, [&](const glm::ivec3&) { return all_children; });
  const TargetBlock block{leaves.origin, 4};
  for (const Projected& projected : regions_) {
    const std::vector<Edge> edges =
        edges_about(projected.edges, patch_of(projected.u, projected.v, block.whole()));
    const glm::dvec2 half = patch_of(projected.u, projected.v, block.child(0)).half;
    for (std::uint64_t rest = leaves.wanted; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      std::uint64_t& word = leaves.words[child];
      if (word == 0) continue;
      const glm::dvec3 centre = block.child(child).centre;
      const Patch patch{{projected.u(centre), projected.v(centre)}, half};
      // Only a leaf that an edge crosses is tested voxel by voxel.
      const Status status = status_of(edges, patch);
      if (status == Status::Empty) word = 0;
      if (status != Status::Partial) continue;
      const glm::ivec3 origin = leaves.origin + 4 * child_place(child);
      Values u, v, crossings{};
      values_at(projected.u, origin, 1.0, u);
      values_at(projected.v, origin, 1.0, v);
      for (const Edge& edge : edges)
        if (within_reach(edge, patch)) count_crossings(edge, u, v, crossings);
      word &= places_of(crossings, 1);
    }
  }
}

}  // namespace octotomy::voxel
