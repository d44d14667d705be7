// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/operand.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "voxel/solid/operand_frame.h"

namespace octotomy::voxel {
namespace {

// A bound of the rounding error of f over a universe. f is a scalar product of four terms, each at most 2^12
// times the gradient. A walk must not decide a block if rounding could change the answer at one of its
// voxels; the result would then depend on the tree's shape.
double rounding_slack(const Linear& f) {
  const double largest = (1 << Universe::max_depth) *
                             (std::abs(f.gradient.x) + std::abs(f.gradient.y) + std::abs(f.gradient.z)) +
                         std::abs(f.constant);
  return 8.0 * std::numeric_limits<double>::epsilon() * largest;
}

}  // namespace

double reach(const Linear& f, double half) {
  assert(half >= 0.0);
  return half * (std::abs(f.gradient.x) + std::abs(f.gradient.y) + std::abs(f.gradient.z)) +
         rounding_slack(f);
}

Linear component(const glm::dmat4& map, int row) {
  return {{map[0][row], map[1][row], map[2][row]}, map[3][row]};
}

Linear along(const glm::dmat4& map, const glm::dvec3& direction, double offset) {
  Linear f;
  for (int row = 0; row < 3; ++row) {
    const Linear part = component(map, row);
    f.gradient += direction[row] * part.gradient;
    f.constant += direction[row] * part.constant;
  }
  f.constant -= offset;
  return f;
}

Operand operand_of(const PostfixExpression::Operand& operand, const Universe& target,
                   const Resampling& resampling) {
  const glm::dmat4 still_from_target = glm::inverse(operand.moved_from_still) * target.lps_from_voxel;
  const auto source_from_target = [&](const Universe& source) {
    return glm::inverse(source.lps_from_voxel) * still_from_target;
  };
  struct Visitor {
    const PostfixExpression::Operand& operand;
    const Universe& target;
    const Resampling& resampling;
    const glm::dmat4& still_from_target;
    const decltype(source_from_target)& source;

    Operand operator()(const Octree& octree) const {
      if (operand.still && octree.universe() == target) return AlignedOctreeOperand{&octree};
      const glm::dmat4 source_from_target = source(octree.universe());
      if (const std::optional<glm::ivec3> offset = whole_voxel_offset(source_from_target))
        return ShiftedOctreeOperand(octree, *offset);
      // A point belongs to a scan if its nearest sample does, so the rule Half is not applied to scans.
      if (resampling.voxels == Resampling::Voxels::Half && !operand.is_scan)
        return HalfOctreeOperand(octree, source_from_target);
      return SampledOctreeOperand(octree, source_from_target);
    }
    Operand operator()(const Window& window) const {
      if (operand.still && window.grey.universe() == target)
        if (const std::optional<Window16> bits = window16(window.low, window.high))
          return WindowOperand(window.grey, *bits);
      return SampledWindowOperand(window, still_from_target, resampling.samples);
    }
    Operand operator()(const RegionMask& mask) const { return MaskOperand(mask, still_from_target); }
    Operand operator()(const SliceMask& mask) const { return SliceMaskOperand(mask, still_from_target); }
    Operand operator()(const HalfSpace& half_space) const {
      return HalfSpaceOperand(half_space, still_from_target);
    }
    Operand operator()(const Sphere& sphere) const { return BallOperand(sphere, still_from_target); }
    Operand operator()(const Ellipsoid& ellipsoid) const { return BallOperand(ellipsoid, still_from_target); }
    Operand operator()(const Box& box) const { return BoxOperand(box, still_from_target); }
    Operand operator()(const OrientedBox& box) const { return BoxOperand(box, still_from_target); }
    Operand operator()(const Cylinder& cylinder) const {
      return CylinderOperand(cylinder, still_from_target);
    }
    Operand operator()(const Torus& torus) const { return TorusOperand(torus, still_from_target); }
  };
  return std::visit(Visitor{operand, target, resampling, still_from_target, source_from_target},
                    *operand.leaf);
}

Cover cover(const Operand& operand, const TargetBlock& block) {
  assert(block.child_side >= 4 && block.margin > 0.0);
  return std::visit(
      [&](const auto& o) -> Cover {
        if constexpr (requires { o.words_are_quick; })
          if (block.child_side == 4) return {0, all_children};
        if constexpr (requires { o.cover(block); })
          return o.cover(block);
        else
          return cover_of_children(block, [&](const Cube& child) { return o.meets(child); });
      },
      operand);
}

void words(const Operand& operand, const WantedLeaves& leaves) {
  assert(leaves.words != nullptr && glm::all(glm::equal(leaves.origin & 15, glm::ivec3(0))));
  std::visit(
      [&](const auto& o) {
        if constexpr (requires { o.words(leaves); })
          o.words(leaves);
        else
          for_each_wanted_voxel(leaves, [&](const glm::dvec3& voxel) { return o.contains(voxel); });
      },
      operand);
}

Meets meets(const Operand& operand, const Cube& cube) {
  return std::visit(
      [&](const auto& o) -> Meets {
        if constexpr (requires { o.meets(cube); }) return o.meets(cube);
        assert(!"the operand cannot be evaluated on a cube");
        return {};
      },
      operand);
}

bool contains(const Operand& operand, const glm::dvec3& p_voxel) {
  return std::visit(
      [&](const auto& o) {
        if constexpr (requires { o.contains(p_voxel); }) return o.contains(p_voxel);
        assert(!"the operand cannot be evaluated at a point");
        return false;
      },
      operand);
}

Sheets sheets(const Operand& operand, const Cube& cube) {
  return std::visit(
      [&](const auto& o) -> Sheets {
        if constexpr (requires { o.sheets(cube); }) return o.sheets(cube);
        return {2, {glm::dvec3(0.0), contains(operand, cube.centre) ? -1.0 : 1.0}, 0.0};
      },
      operand);
}

}  // namespace octotomy::voxel
