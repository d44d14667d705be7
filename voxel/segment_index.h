// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/octree.h"

namespace octotomy::voxel {

/// Voxels first..last of a row, both included.
struct Segment {
  std::uint16_t first = 0;
  std::uint16_t last = 0;
  bool operator==(const Segment&) const = default;
};

/// Segment-indexed code (thesis 3.2.4, after Tuy and Reynolds): a row's runs as segments, reached by the
/// indices of slice and row. Slices and rows that hold nothing are empty lists, the thesis's null pointers.
struct SegmentIndex {
  using Row = std::vector<Segment>;
  using Slice = std::vector<Row>;  ///< no rows, or as many as the universe's side

  Universe universe;
  std::vector<Slice> slices;  ///< as many as the universe's side
};

/// Cost: the slices that hold a voxel, side^2 / 8 bytes each. Memory: 24 bytes a slice, 24 a row of a slice
/// that holds a voxel, 4 a segment.
SegmentIndex segment_index(const Octree& octree);
/// Throws std::invalid_argument naming slice and row where there are not as many as the universe asks, and
/// the segment that ends before it begins, leaves the row, or does not begin at least two voxels after its
/// predecessor's end; and a slice whose rows are all empty, which has no rows.
Octree octree_of(const SegmentIndex& index);
/// Whether a voxel is in the object, by indices of slice and row. Precondition: inside the universe.
bool contains(const SegmentIndex& index, const glm::ivec3& voxel);

/// A line a slice, its number and its rows, a row's segments joined by commas: `1 Null 3:3 0:2 0:1`. A slice
/// without voxels is `4 Null`.
std::string text(const SegmentIndex& index);
/// The inverse. Throws std::invalid_argument with the position of the character; segments are checked by
/// octree_of(). Memory: in proportion to the text, and 24 bytes a slice of the universe.
SegmentIndex parse_segment_index(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
