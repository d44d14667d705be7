// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The binary digital array (thesis 3.2.1) with eight voxels in a byte: voxel i, counted x fastest, then y,
/// then z, is bit i % 8 of byte i / 8.
struct BinaryArray {
  /// Above this depth 8^depth bits are more than a gigabyte.
  static constexpr int max_depth = 11;

  Universe universe;
  std::vector<std::uint8_t> bytes;  ///< 8^depth / 8
};

/// The array of an octree's voxels. Throws std::length_error for universes deeper than max_depth. Cost: one
/// pass over the slices that are not empty.
BinaryArray binary_array(const Octree& octree);
/// The object of an array. Throws std::invalid_argument if the array has not one bit for each voxel of the
/// universe.
Octree octree_of(const BinaryArray& array);

/// The slices as the thesis prints them: `Slice 0 :`, then one line per row such as `0 1 1 0`, and so on.
/// Throws std::length_error for universes deeper than 9 levels, whose text is larger than two gigabytes.
std::string text(const BinaryArray& array);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character. Memory: one
/// bit for each voxel of the universe.
BinaryArray parse_binary_array(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
