// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "voxel/program.h"
#include "voxel/window_bits.h"

// Operands as a walk over a target universe meets them. Each answers two questions: which of a block's 64
// children are Full or Empty, and which voxels of a leaf are inside. Positions are the target's voxel
// indices. The first answer may leave a child undecided; the second one is exact: a voxel is inside where its
// centre is (D3).

namespace octotomy::voxel {

/// A block of the target: 64 children of `child_side` voxels a side from `origin` on.
struct TargetBlock {
  glm::ivec3 origin{0};
  int child_side = 4;
};

/// f(v) = gradient . v + constant over the target's voxel indices.
struct Linear {
  glm::dvec3 gradient{0.0};
  double constant = 0.0;

  double operator()(const glm::dvec3& v) const { return glm::dot(gradient, v) + constant; }
};

/// Voxels where every function is at most zero: a half-space, a box under any motion.
class ConvexOperand {
 public:
  explicit ConvexOperand(std::vector<Linear> sides) : sides_(std::move(sides)) {}
  Cover cover(const TargetBlock& block) const;
  std::uint64_t leaf(const glm::ivec3& origin) const;

 private:
  std::vector<Linear> sides_;
};

class SphereOperand {
 public:
  SphereOperand(const Sphere& sphere, const glm::dmat4& still_from_target)
      : sphere_(sphere), still_from_target_(still_from_target) {}
  Cover cover(const TargetBlock& block) const;
  std::uint64_t leaf(const glm::ivec3& origin) const;

 private:
  Sphere sphere_;
  glm::dmat4 still_from_target_;
};

/// The intersection of regions' back-projections.
class MaskOperand {
 public:
  MaskOperand(const RegionMask& mask, const glm::dmat4& still_from_target);
  Cover cover(const TargetBlock& block) const;
  std::uint64_t leaf(const glm::ivec3& origin) const;

 private:
  struct Projected {
    const Region* region = nullptr;
    Linear u, v;  ///< the view's millimetres
  };
  std::vector<Projected> regions_;
};

/// A grey octree's window on the target's own lattice.
class WindowOperand {
 public:
  WindowOperand(const GreyOctree& grey, Window16 window) : grey_(&grey), window_(window) {}
  Cover cover(const TargetBlock& block) const;
  std::uint64_t leaf(const glm::ivec3& origin) const;

 private:
  const GreyOctree* grey_;
  Window16 window_;
};

/// An octree on another lattice or under a motion.
class SampledOctreeOperand {
 public:
  SampledOctreeOperand(const Octree& octree, const glm::dmat4& source_from_target)
      : octree_(&octree), source_from_target_(source_from_target) {}
  Cover cover(const TargetBlock& block) const;
  std::uint64_t leaf(const glm::ivec3& origin) const;

 private:
  const Octree* octree_;
  glm::dmat4 source_from_target_;
};

/// A grey octree's window on another lattice or under a motion: samples are interpolated, then compared.
class SampledWindowOperand {
 public:
  SampledWindowOperand(const Window& window, const glm::dmat4& source_from_target)
      : window_(&window), source_from_target_(source_from_target) {}
  Cover cover(const TargetBlock& block) const;
  std::uint64_t leaf(const glm::ivec3& origin) const;

 private:
  const Window* window_;
  glm::dmat4 source_from_target_;
};

/// An octree on the target's own lattice: the walk follows its nodes.
struct AlignedOctreeOperand {
  BlockRef root;
};

using Operand = std::variant<AlignedOctreeOperand, ConvexOperand, SphereOperand, MaskOperand, WindowOperand,
                             SampledOctreeOperand, SampledWindowOperand>;

/// The operand for a walk over `target`; it refers to the expression behind it.
Operand operand_of(const Program::Operand& operand, const Universe& target);

}  // namespace octotomy::voxel
