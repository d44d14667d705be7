// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A segment of a row: its voxels first..last, both included.
struct Segment {
  std::uint16_t first = 0;
  std::uint16_t last = 0;
  bool operator==(const Segment&) const = default;
};

/// Segment-indexed code (thesis 3.2.4, after Tuy and Reynolds): the runs of each row, called segments,
/// indexed by slice and row. Slices and rows without voxels are empty lists, the thesis's null pointers.
struct SegmentIndex {
  using Row = std::vector<Segment>;
  using Slice = std::vector<Row>;  ///< empty if no voxel is set, else one row for each y

  Universe universe;
  std::vector<Slice> slices;  ///< one slice for each z of the universe
};

/// The segments of an octree. Cost: reads the slices that are not empty, side^2 / 8 bytes each. Memory: 24
/// bytes per slice, 24 per row of a non-empty slice, 4 per segment.
SegmentIndex segment_index(const Octree& octree);
/// The object of an index. Throws std::invalid_argument with the slice that has a wrong number of rows or
/// only empty rows, or with the segment that ends before it begins, leaves the row, or begins less than two
/// voxels after its predecessor's end.
Octree octree_of(const SegmentIndex& index);
/// Whether a voxel is in the object. Precondition: the voxel is in the universe.
bool contains(const SegmentIndex& index, const glm::ivec3& voxel);

/// One line per slice with its number and its rows, a row's segments joined by commas: `1 Null 3:3 0:2 0:1`.
/// A slice without voxels is `4 Null`.
std::string text(const SegmentIndex& index);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character; octree_of()
/// checks the segments. Memory: in proportion to the text, and 24 bytes per slice of the universe.
SegmentIndex parse_segment_index(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
