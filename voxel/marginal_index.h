// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/octree.h"

namespace octotomy::voxel {

/// The marginal index (thesis 3.2.2, after Srihari; order z, y, x): slices of rows of voxels in which slices
/// and rows that hold nothing are empty lists, the thesis's null pointers. A row's voxel x is bit x % 64 of
/// its word x / 64; bits beyond the universe are zero.
struct MarginalIndex {
  using Row = std::vector<std::uint64_t>;  ///< no words, or a word for every 64 voxels of the side begun
  using Slice = std::vector<Row>;          ///< no rows, or as many as the universe's side

  Universe universe;
  std::vector<Slice> slices;  ///< as many as the universe's side
};

/// Cost: the slices that hold a voxel, side^2 / 8 bytes each. Memory: 24 bytes a slice, 24 a row of a slice
/// that holds a voxel, a bit a voxel of a row that holds one.
MarginalIndex marginal_index(const Octree& octree);
/// Throws std::invalid_argument naming the slice or row that is not as long as the universe asks, has bits
/// beyond it, or holds nothing without being an empty list.
Octree octree_of(const MarginalIndex& index);
/// Whether a voxel is in the object, by its three indices. Precondition: inside the universe.
bool contains(const MarginalIndex& index, const glm::ivec3& voxel);

/// A line a slice, its number and its rows: `1 Null 0001 1110 1100`. A slice without voxels is `4 Null`.
std::string text(const MarginalIndex& index);
/// The inverse. Throws std::invalid_argument with the position of the character. Memory: in proportion to the
/// text, and 24 bytes a slice of the universe.
MarginalIndex parse_marginal_index(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
