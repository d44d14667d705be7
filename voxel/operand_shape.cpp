// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "voxel/operand.h"
#include "voxel/operand_frame.h"

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

template <typename Visit>
void for_each_edge(const Region& region, const Visit& visit) {
  for (const std::vector<glm::dvec2>& polygon : region.polygons_mm)
    for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++)
      visit(polygon[last], polygon[i]);
}

Status status_in_region(const Region& region, const glm::dvec2& centre, const glm::dvec2& half) {
  bool mixed = false;
  for_each_edge(
      region, [&](const glm::dvec2& a, const glm::dvec2& b) { mixed = mixed || meets(a, b, centre, half); });
  if (mixed) return Status::Mixed;
  return contains(region, centre) ? Status::Full : Status::Empty;
}

}  // namespace

Cover ConvexOperand::cover(const TargetBlock& block) const {
  Cover cover{all_children, all_children};
  for (const Linear& side : sides_) {
    const double stray = reach(side, block.child_side);
    cover = cover & cover_of_children(block, [&](const glm::dvec3& centre) {
              const double value = side(centre);
              if (value + stray <= 0.0) return Status::Full;
              return value - stray > 0.0 ? Status::Empty : Status::Mixed;
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
    return glm::dot(farthest, farthest) <= square ? Status::Full : Status::Mixed;
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
  for (const Projected& projected : regions_) {
    const glm::dvec2 half(reach(projected.u, block.child_side), reach(projected.v, block.child_side));
    cover = cover & cover_of_children(block, [&](const glm::dvec3& centre) {
              return status_in_region(*projected.region, {projected.u(centre), projected.v(centre)}, half);
            });
    if (cover.some == 0) break;
  }
  return cover;
}

void MaskOperand::words(const WantedLeaves& leaves) const {
  // Regions all over the leaf are not asked voxel by voxel, and nor are edges above or below all of it, which
  // a ray from one of its voxels cannot cross.
  std::vector<std::array<glm::dvec2, 2>> edges;
  for_each_wanted(leaves, [&](const glm::ivec3& origin) {
    std::uint64_t word = all_children;
    for (const Projected& projected : regions_) {
      const glm::dvec3 middle = glm::dvec3(origin) + 1.5;
      const glm::dvec2 centre(projected.u(middle), projected.v(middle));
      const glm::dvec2 half(reach(projected.u, 4), reach(projected.v, 4));
      const Status status = status_in_region(*projected.region, centre, half);
      if (status == Status::Full) continue;
      if (status == Status::Empty) return std::uint64_t{0};
      edges.clear();
      for_each_edge(*projected.region, [&](const glm::dvec2& a, const glm::dvec2& b) {
        if (std::min(a.y, b.y) <= centre.y + half.y && std::max(a.y, b.y) >= centre.y - half.y)
          edges.push_back({a, b});
      });
      for (std::uint64_t rest = word; rest != 0; rest &= rest - 1) {
        const glm::dvec3 voxel(origin + child_place(std::countr_zero(rest)));
        const glm::dvec2 p_mm(projected.u(voxel), projected.v(voxel));
        bool inside = false;
        for (const auto& [a, b] : edges) inside ^= crosses_ray_from(a, b, p_mm);
        if (!inside) word &= ~(rest & (~rest + 1));
      }
    }
    return word;
  });
}

}  // namespace octotomy::voxel
