// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A solid as voxels, with the share of each voxel that it fills. Two octrees contain the voxels wholly
/// inside (D1) and the voxels that the solid touches (D2). The voxels touched but not wholly inside are the
/// solid's boundary voxels.
struct PartialOctree {
  /// The value of a fraction that represents a wholly filled voxel.
  static constexpr std::uint16_t whole = 65535;

  Octree inside;
  Octree touching;
  /// One fraction per voxel of touching - inside, in tree order: blocks depth first with child numbers
  /// ascending (octree_node.h), voxels of a leaf in bit order. The share filled is fraction / whole.
  std::vector<std::uint16_t> fractions;
};

/// Throws std::invalid_argument if the universes differ, a voxel is in `inside` but not in `touching`, or the
/// number of fractions is not that of the boundary voxels.
void check(const PartialOctree& partial);

/// The numbers of nodes on levels 1..n, as the thesis counts them for its digital sphere (table 3.1). A node
/// is Full only if it lies wholly inside, and Empty only if the solid does not touch it. At level n a
/// boundary voxel counts as Full, but is not merged into its parent. Precondition: passes check().
std::vector<LevelCount> level_counts(const PartialOctree& partial);

/// Visits every boundary voxel with its fraction, in tree order. Precondition: passes check().
void for_each_boundary_voxel(
    const PartialOctree& partial,
    const std::function<void(const glm::ivec3& voxel, std::uint16_t fraction)>& visit);

/// The voxels at least half filled (D4). Precondition: passes check().
Octree at_least_half(const PartialOctree& partial);

/// The shares of voxels as samples from 0 to 1, in steps of 1 / 32767: the window from half_share up has the
/// voxels of at_least_half(). Its surface, interpolated between voxel centres, is the partial-volume surface
/// (thesis 5.2.2.2). The whole universe counts as scanned. Precondition: passes check(). Parallel. Memory:
/// two bytes for each voxel of the blocks of 16 x 16 x 16 that the solid touches.
inline constexpr double half_share = 0.5;
GreyOctree share_samples(const PartialOctree& partial);

/// The solid's volume in cubic millimetres, computed from the fractions. Integers are summed, so the only
/// error is the rounding of each fraction to 1 / 65535.
double volume_mm3(const PartialOctree& partial);

/// The memory of both octrees and of the fractions, in bytes.
std::uint64_t bytes_memory(const PartialOctree& partial);

}  // namespace octotomy::voxel
