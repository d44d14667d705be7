// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "voxel/solid/operand.h"
#include "voxel/solid/operand_frame.h"
#include "voxel/space/vector_clones.h"

namespace octotomy::voxel {
namespace {

// Whether a segment meets a rectangle, by separating axes: the rectangle's two and the segment's normal.
bool meets(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& centre, const glm::dvec2& half) {
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
Patch patch_of(const Linear& u, const Linear& v, const glm::dvec3& centre, int side) {
  return {{u(centre), v(centre)}, {reach(u, side), reach(v, side)}};
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
  for (const std::vector<glm::dvec2>& polygon : region.polygons_mm)
    for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++) {
      const Edge edge{polygon[last], polygon[i]};
      if (within_reach(edge, patch) ||
          (edge[0].y == edge[1].y && meets(edge[0], edge[1], patch.centre, patch.half)))
        edges.push_back(edge);
    }
  return edges;
}

Status status_of(const std::vector<Edge>& edges, const Patch& patch) {
  bool inside = false;
  for (const auto& [a, b] : edges) {
    if (meets(a, b, patch.centre, patch.half)) return Status::Partial;
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

Cover ConvexOperand::cover(const TargetBlock& block) const {
  Cover cover{all_children, all_children};
  for (const Linear& side : sides_) {
    const double stray = reach(side, block.child_side);
    cover = cover & cover_of_children(block, [&](const glm::dvec3& centre) {
              const double value = side(centre);
              if (value + stray <= 0.0) return Status::Full;
              return value - stray > 0.0 ? Status::Empty : Status::Partial;
            });
  }
  return cover;
}

void ConvexOperand::words(const WantedLeaves& leaves) const {
  for_each_wanted_voxel(leaves, [&](const glm::dvec3& voxel) {
    return std::all_of(sides_.begin(), sides_.end(), [&](const Linear& side) { return side(voxel) <= 0.0; });
  });
}

Cover SphereOperand::cover(const TargetBlock& block) const {
  const Imager image(still_from_target_, block.child_side);
  const double square = sphere_.radius_mm * sphere_.radius_mm;
  return cover_of_children(block, [&](const glm::dvec3& centre) {
    const ImageBox box = image(centre);
    const glm::dvec3 nearest = glm::clamp(sphere_.centre_mm, box.low, box.high) - sphere_.centre_mm;
    const glm::dvec3 farthest =
        glm::max(glm::abs(box.low - sphere_.centre_mm), glm::abs(box.high - sphere_.centre_mm));
    if (glm::dot(nearest, nearest) > square) return Status::Empty;
    return glm::dot(farthest, farthest) <= square ? Status::Full : Status::Partial;
  });
}

void SphereOperand::words(const WantedLeaves& leaves) const {
  const double square = sphere_.radius_mm * sphere_.radius_mm;
  for_each_wanted_voxel(leaves, [&](const glm::dvec3& voxel) {
    const glm::dvec3 from_centre =
        glm::dvec3(still_from_target_ * glm::dvec4(voxel, 1.0)) - sphere_.centre_mm;
    return glm::dot(from_centre, from_centre) <= square;
  });
}

MaskOperand::MaskOperand(const RegionMask& mask, const glm::dmat4& still_from_target) {
  for (const Region& region : mask.regions)
    regions_.push_back({&region, along(still_from_target, region.view.right, 0.0),
                        along(still_from_target, region.view.up, 0.0)});
}

Cover MaskOperand::cover(const TargetBlock& block) const {
  Cover cover{all_children, all_children};
  const glm::dvec3 middle = glm::dvec3(block.origin) + 0.5 * (4 * block.child_side - 1);
  for (const Projected& projected : regions_) {
    const Patch whole = patch_of(projected.u, projected.v, middle, 4 * block.child_side);
    const std::vector<Edge> edges = edges_about(*projected.region, whole);
    const Status status = status_of(edges, whole);
    if (status == Status::Empty) return {};
    if (status == Status::Full) continue;
    const glm::dvec2 half = patch_of(projected.u, projected.v, middle, block.child_side).half;
    cover = cover & cover_of_children(block, [&](const glm::dvec3& centre) {
              return status_of(edges, {{projected.u(centre), projected.v(centre)}, half});
            });
    if (cover.some == 0) break;
  }
  return cover;
}

void MaskOperand::words(const WantedLeaves& leaves) const {
  for_each_wanted(leaves, [&](const glm::ivec3&) { return all_children; });
  const glm::dvec3 middle = glm::dvec3(leaves.origin) + 7.5;
  for (const Projected& projected : regions_) {
    const std::vector<Edge> edges =
        edges_about(*projected.region, patch_of(projected.u, projected.v, middle, 16));
    const glm::dvec2 half = patch_of(projected.u, projected.v, middle, 4).half;
    for (std::uint64_t rest = leaves.wanted; rest != 0; rest &= rest - 1) {
      const int child = std::countr_zero(rest);
      std::uint64_t& word = leaves.words[child];
      if (word == 0) continue;
      const glm::ivec3 origin = leaves.origin + 4 * child_place(child);
      const glm::dvec3 centre = glm::dvec3(origin) + 1.5;
      const Patch patch{{projected.u(centre), projected.v(centre)}, half};
      // Only where an edge passes is a leaf asked voxel by voxel.
      const Status status = status_of(edges, patch);
      if (status == Status::Empty) word = 0;
      if (status != Status::Partial) continue;
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
