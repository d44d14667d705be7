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

/// Combines word by word. Cost: the array.
BinaryArray combined(const BinaryArray& a, const BinaryArray& b, SetOperation operation);
/// Combines row by row, and skips null rows and slices where the operation allows it.
MarginalIndex combined(const MarginalIndex& a, const MarginalIndex& b, SetOperation operation);
/// Merges the two lists. Cost: their lengths.
RunLength combined(const RunLength& a, const RunLength& b, SetOperation operation);
/// Merges the lists of each row. Cost: their lengths, and one look at each row.
SegmentIndex combined(const SegmentIndex& a, const SegmentIndex& b, SetOperation operation);

}  // namespace octotomy::voxel
