// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/codes/binary_array.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/codes/run_length.h"
#include "voxel/codes/segment_index.h"

namespace octotomy::voxel {

/// The view of an object along an axis: for each column of voxels, the number of voxels before the first
/// voxel of the object.
struct Projection {
  int side = 0;
  /// Column (i, j) is entry i + side j; i and j count along the two other axes of the universe in their
  /// order. -1: an empty column.
  std::vector<std::int32_t> before;
  std::uint64_t visited = 0;  ///< elements of the code that were read: faces, voxels, runs or segments

  bool operator==(const Projection& other) const { return side == other.side && before == other.before; }
};

// Each code is drawn by the algorithm that the thesis describes for it. The observer stands beyond the
// universe in the direction `from`. All return the same columns.

/// Face lists (4.4.1.2.2): only the list that faces the observer, into a depth buffer.
Projection projection(const CuberilleFaces& faces, Direction from);
/// Digital array (4.4.2.1): back to front, slice by slice and row by row. Reads every voxel.
Projection projection(const BinaryArray& array, Direction from);
/// Runs (3.2.3): back to front in the order of the list, or its reverse.
Projection projection(const RunLength& runs, Direction from);
/// Segments (4.4.2.2, after Reynolds): front to back against a dynamic screen, which holds the parts of each
/// row of the picture that are not painted yet. Segments behind a row without such parts are not read.
Projection projection(const SegmentIndex& index, Direction from);

}  // namespace octotomy::voxel
