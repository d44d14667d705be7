// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "voxel/solid/edge_tree.h"
#include "voxel/solid/operand_primitive.h"
#include "voxel/solid/postfix_expression.h"
#include "voxel/solid/resampling.h"
#include "voxel/tree/window_bits.h"

// Operands in the form that a walk over a target universe uses. Positions are the target's voxel indices. An
// operand answers three queries: whether a cube has parts inside and outside (meets), whether a point is
// inside (contains), and which voxels of a leaf have their centre inside (words; D3). The answer about a cube
// may be undecided; the others are exact. Some operand types have their own cover() and words(), which are
// faster for a block's 64 children or for leaves.

namespace octotomy::voxel {

/// A block of the target: 64 children, each `child_side` voxels a side. `origin` is the block's lowest voxel.
/// A child's cube extends `margin` voxels beyond the centres of its voxels.
struct TargetBlock {
  /// The margin for tests of voxel centres: it covers their rounding, because coordinates of up to 2^36
  /// voxels are rounded to 2^-16 of a voxel.
  static constexpr double centres = 0x1p-16;
  static constexpr double cuboids = 0.5;  ///< covers whole voxels

  glm::ivec3 origin{0};
  int child_side = 4;
  double margin = centres;

  Cube child(int number) const { return cube(origin + child_place(number) * child_side, child_side); }
  Cube whole() const { return cube(origin, 4 * child_side); }

 private:
  Cube cube(const glm::ivec3& first, int side) const {
    return {glm::dvec3(first) + 0.5 * (side - 1), 0.5 * (side - 1) + margin};
  }
};

/// Output of words() for a block of height 2: for each bit set in `wanted`, words[bit number] receives the
/// word of the leaf with this child number.
struct WantedLeaves {
  glm::ivec3 origin{0};  ///< of the block
  std::uint64_t wanted = 0;
  std::uint64_t* words = nullptr;
};

/// f(v) = gradient . v + constant over the target's voxel indices.
struct Linear {
  glm::dvec3 gradient{0.0};
  double constant = 0.0;

  double operator()(const glm::dvec3& v) const { return glm::dot(gradient, v) + constant; }
};

/// The intersection of the back-projections of several regions.
class MaskOperand {
 public:
  MaskOperand(const RegionMask& mask, const glm::dmat4& still_from_target);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  Sheets sheets(const Cube& cube) const;
  Cover cover(const TargetBlock& block) const;
  void words(const WantedLeaves& leaves) const;

 private:
  struct Projected {
    EdgeTree edges;
    Linear u, v;  ///< coordinates in the view in millimetres, as functions of target voxels
    LocalFrame frame() const;
  };
  std::vector<Projected> regions_;
};

/// The volume interpolated between regions on parallel slices.
class SliceMaskOperand {
 public:
  SliceMaskOperand(const SliceMask& mask, const glm::dmat4& still_from_target);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;

 private:
  SliceDistance distance_;
  /// Coordinates in the view and across the slices in millimetres, as functions of target voxels.
  Linear u_, v_, w_;
};

/// A grey octree's window on the target's own lattice.
class WindowOperand {
 public:
  WindowOperand(const GreyOctree& grey, Window16 window) : grey_(&grey), window_(window) {}
  Cover cover(const TargetBlock& block) const;
  void words(const WantedLeaves& leaves) const;

 private:
  const GreyOctree* grey_;
  Window16 window_;
};

/// An octree under a translation by whole voxels: words are shifted into place, without sampling.
class ShiftedOctreeOperand {
 public:
  /// Target voxel t is the octree's voxel t + source_offset.
  ShiftedOctreeOperand(const Octree& octree, const glm::ivec3& source_offset)
      : octree_(&octree), source_offset_(source_offset) {}
  static constexpr bool words_are_quick = true;
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  void words(const WantedLeaves& leaves) const;

 private:
  const Octree* octree_;
  glm::ivec3 source_offset_;
};

/// An octree on another lattice or under a motion. Positions are rounded to 2^-24 of a voxel, so a centre
/// closer than that to the face between two voxels may be assigned to either.
class SampledOctreeOperand {
 public:
  SampledOctreeOperand(const Octree& octree, const glm::dmat4& source_from_target);
  static constexpr bool words_are_quick = true;
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  void words(const WantedLeaves& leaves) const;

 private:
  using Offsets = std::array<std::int32_t, 64>;
  std::uint64_t leaf(const class LeafWords& region, const glm::ivec3& base) const;

  const Octree* octree_;
  glm::dmat4 source_from_target_;
  /// Offsets from a leaf's first voxel to each of its voxels, in voxels of the source as fixed-point numbers;
  /// and the bounds of these offsets.
  std::array<Offsets, 3> offsets_;
  glm::ivec3 lowest_{0}, highest_{0};
};

/// An octree on another lattice or under a motion: a voxel is inside if most of 5 x 5 x 5 points in the voxel
/// are inside (D4).
class HalfOctreeOperand {
 public:
  HalfOctreeOperand(const Octree& octree, const glm::dmat4& source_from_target);
  Meets meets(const Cube& cube) const;
  void words(const WantedLeaves& leaves) const;

 private:
  const Octree* octree_;
  glm::dmat4 source_from_target_;
  /// Offsets of the points from a voxel's centre, in voxels of the source.
  std::array<glm::dvec3, 125> points_;
  glm::dvec3 reach_{0.0};  ///< largest offset of a point along each axis
};

/// A grey octree's window on another lattice or under a motion: samples on the scan's own lattice are
/// interpolated, then compared with the window. Under a translation by whole voxels every centre lies at a
/// sample, and words are shifted into place.
class SampledWindowOperand {
 public:
  SampledWindowOperand(const Window& window, const glm::dmat4& still_from_target,
                       Interpolation interpolation);
  static constexpr bool words_are_quick = true;
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  void words(const WantedLeaves& leaves) const;

 private:
  void interpolated_words(const WantedLeaves& leaves) const;

  GreyOctree grey_;
  double low_, high_;
  glm::dmat4 source_from_target_;
  std::optional<glm::ivec3> source_offset_;
  Interpolation interpolation_;
};

/// An octree on the target's own lattice. A walk over blocks follows its nodes and does not call these
/// functions.
struct AlignedOctreeOperand {
  const Octree* octree;
  Meets meets(const Cube& cube) const { return ShiftedOctreeOperand(*octree, glm::ivec3(0)).meets(cube); }
  bool contains(const glm::dvec3& p_voxel) const {
    return ShiftedOctreeOperand(*octree, glm::ivec3(0)).contains(p_voxel);
  }
};

using Operand =
    std::variant<AlignedOctreeOperand, ShiftedOctreeOperand, SampledOctreeOperand, HalfOctreeOperand,
                 WindowOperand, SampledWindowOperand, MaskOperand, SliceMaskOperand, HalfSpaceOperand,
                 BallOperand, BoxOperand, CylinderOperand, TorusOperand>;

/// The operand for a walk over `target`. The expression must outlive it.
Operand operand_of(const PostfixExpression::Operand& operand, const Universe& target,
                   const Resampling& resampling);

/// The status of a block's children. Children of 4 voxels a side may remain undecided; words() computes
/// these.
Cover cover(const Operand& operand, const TargetBlock& block);
void words(const Operand& operand, const WantedLeaves& leaves);
/// Precondition of meets(), contains() and sheets(): the operand is no WindowOperand and no
/// HalfOctreeOperand.
Meets meets(const Operand& operand, const Cube& cube);
bool contains(const Operand& operand, const glm::dvec3& p_voxel);
/// The operand's surfaces within a cube. Precondition: its surface cuts the cube. An operand without tangents
/// returns two surfaces with a zero gradient; callers then split the cube further and finally count it by its
/// centre.
Sheets sheets(const Operand& operand, const Cube& cube);

}  // namespace octotomy::voxel
