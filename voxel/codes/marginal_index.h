// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The marginal index (thesis 3.2.2, after Srihari; order z, y, x): slices of rows of voxels. Slices and rows
/// without voxels are empty lists, the thesis's null pointers. A row's voxel x is bit x % 64 of its word
/// x / 64; bits beyond the universe are zero.
struct MarginalIndex {
  using Row = std::vector<std::uint64_t>;  ///< empty if no voxel is set, else ceil(side / 64) words
  using Slice = std::vector<Row>;          ///< empty if no voxel is set, else one row for each y

  Universe universe;
  std::vector<Slice> slices;  ///< one slice for each z of the universe
};

/// The marginal index of an octree. Cost: reads the slices that are not empty, side^2 / 8 bytes each. Memory:
/// 24 bytes per slice, 24 per row of a non-empty slice, one bit per voxel of a non-empty row.
MarginalIndex marginal_index(const Octree& octree);
/// The object of an index. Throws std::invalid_argument with the slice or row that has a wrong length, bits
/// beyond the universe, or no voxel although it is not an empty list.
Octree octree_of(const MarginalIndex& index);
/// Whether a voxel is in the object. Precondition: the voxel is in the universe.
bool contains(const MarginalIndex& index, const glm::ivec3& voxel);

/// One line per slice with its number and its rows: `1 Null 0001 1110 1100`. A slice without voxels is
/// `4 Null`.
std::string text(const MarginalIndex& index);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character. Memory: in
/// proportion to the text, and 24 bytes per slice of the universe.
MarginalIndex parse_marginal_index(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
