// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/codes/binary_array.h"
#include "voxel/codes/marginal_index.h"
#include "voxel/codes/run_length.h"
#include "voxel/codes/segment_index.h"

namespace octotomy::voxel {

/// The Booleans of thesis 7.2.
enum class SetOperation { Intersection, Union, Difference };

// Booleans of two objects in the same code, without an octree. Each throws std::invalid_argument if the
// universes differ. Precondition: both codes pass the checks of octree_of().

/// Combines the arrays word by word. Cost: one pass over them.
BinaryArray combined(const BinaryArray& a, const BinaryArray& b, SetOperation operation);
/// Combines the indices row by row. Skips null rows and null slices if the operation's result is known
/// without them.
MarginalIndex combined(const MarginalIndex& a, const MarginalIndex& b, SetOperation operation);
/// Merges the two lists of runs. Cost: linear in their lengths.
RunLength combined(const RunLength& a, const RunLength& b, SetOperation operation);
/// Merges the two lists of segments of each row. Cost: linear in the number of segments and of rows.
SegmentIndex combined(const SegmentIndex& a, const SegmentIndex& b, SetOperation operation);

}  // namespace octotomy::voxel
