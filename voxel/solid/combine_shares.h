// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/tree/partial_octree.h"

namespace octotomy::voxel {

/// For every voxel, bounds of the share that a solid fills: at least `low` and at most `high`. The shares of
/// two solids do not determine how the solids overlap within a voxel, so the share of their Boolean lies
/// between two bounds. The bounds coincide in voxels wholly inside or outside, and in voxels that only one
/// solid's boundary crosses.
struct ShareBracket {
  Octree inside;    ///< filled for certain
  Octree touching;  ///< perhaps filled in part
  /// Bounds for the voxels of touching - inside, in tree order as PartialOctree::fractions.
  /// PartialOctree::whole represents a share of 1.
  std::vector<std::uint16_t> low, high;
};

/// The shares of a partial octree as exact bounds, low = high. Throws as check(PartialOctree) does.
ShareBracket bracket_of(const PartialOctree& partial);

/// A leaf of an expression, and the shares that replace this leaf.
struct ShareOperand {
  Expression symbol;
  ShareBracket shares;
};

/// Evaluates an expression whose leaves are the operands' symbols, voxel by voxel with Frechet's bounds: the
/// share of a & b lies between max(0, a + b - 1) and min(a, b), of a | b between max(a, b) and min(1, a + b),
/// and of a ^ b between |a - b| and min(a + b, 2 - a - b); a - b is a & ~b. The bounds are the tightest for
/// two solids of known shares. They remain valid but become wider than necessary if an operand occurs twice
/// or three boundaries cross one voxel. Exact except for the rounding of the shares to 1 / 65535. Throws
/// std::invalid_argument if the universes differ, a leaf is none of the symbols, or the expression moves a
/// part: shares cannot be transferred to a moved lattice. Cost: n log n for n boundary voxels of the
/// operands.
ShareBracket combine_shares(const Expression& expression, const std::vector<ShareOperand>& operands);

/// Bounds of a volume, in cubic millimetres.
struct VolumeBracket {
  double low_mm3 = 0.0;
  double high_mm3 = 0.0;
  double middle_mm3() const { return 0.5 * (low_mm3 + high_mm3); }
  double half_width_mm3() const { return 0.5 * (high_mm3 - low_mm3); }
};
VolumeBracket volume_mm3(const ShareBracket& bracket);

/// For every voxel, the share half-way between its bounds.
PartialOctree middle(const ShareBracket& bracket);

}  // namespace octotomy::voxel
