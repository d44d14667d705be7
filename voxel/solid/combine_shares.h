// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/tree/partial_octree.h"

namespace octotomy::voxel {

/// What is known of the share of every voxel that a solid fills: at least `low` and at most `high` of it. The
/// shares of two solids do not tell how they overlap within a voxel, so a Boolean of them is known between
/// two bounds. Both are the same in voxels wholly in or out, and in voxels with the boundary of only one
/// solid.
struct ShareBracket {
  Octree inside;    ///< filled for certain
  Octree touching;  ///< perhaps filled in part
  /// Of the voxels of touching - inside, in tree order as PartialOctree::fractions; of PartialOctree::whole.
  std::vector<std::uint16_t> low, high;
};

/// Shares that are known: both bounds the same. Throws as check(PartialOctree).
ShareBracket bracket_of(const PartialOctree& partial);

/// A symbol of an expression and what it stands for.
struct ShareOperand {
  Expression symbol;
  ShareBracket shares;
};

/// Evaluates an expression of such symbols, voxel by voxel, with the bounds of Frechet: a share of a & b is
/// from max(0, a + b - 1) to min(a, b), of a | b from max(a, b) to min(1, a + b), of a ^ b from |a - b| to
/// min(a + b, 2 - a - b); a - b is a & ~b. They are the tightest for two solids of known shares; if one
/// operand occurs twice, or three have their boundary in one voxel, they are wider than need be and never
/// wrong. Exact but for the shares' own rounding to 1 / 65535. Throws std::invalid_argument if the universes
/// differ, a leaf is none of the symbols, or the expression moves a part: shares do not turn with a lattice.
/// Cost: n log n of the operands' boundary voxels.
ShareBracket combine_shares(const Expression& expression, const std::vector<ShareOperand>& operands);

/// The volume is from low to high, in cubic millimetres.
struct VolumeBracket {
  double low_mm3 = 0.0;
  double high_mm3 = 0.0;
  double middle_mm3() const { return 0.5 * (low_mm3 + high_mm3); }
  double half_width_mm3() const { return 0.5 * (high_mm3 - low_mm3); }
};
VolumeBracket volume_mm3(const ShareBracket& bracket);

/// The shares half-way between the bounds.
PartialOctree middle(const ShareBracket& bracket);

}  // namespace octotomy::voxel
