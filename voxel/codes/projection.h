// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/codes/binary_array.h"
#include "voxel/codes/cuberille_faces.h"
#include "voxel/codes/run_length.h"
#include "voxel/codes/segment_index.h"

namespace octotomy::voxel {

/// The view of an object along an axis: for each column of voxels, the number of voxels between the observer
/// and the object's first voxel.
struct Projection {
  int side = 0;
  /// Column (i, j) is entry i + side j; i and j count along the two other axes of the universe in their
  /// order. The entry of an empty column is -1.
  std::vector<std::int32_t> before;
  /// Number of elements of the code that were read: faces, voxels, runs or segments.
  std::uint64_t visited = 0;

  bool operator==(const Projection& other) const { return side == other.side && before == other.before; }
};

// Each code is drawn by the algorithm that the thesis describes for it. The observer stands beyond the
// universe in the direction `from`. All functions return the same columns.

/// Face lists (4.4.1.2.2): draws only the list of faces towards the observer, into a depth buffer.
Projection projection(const CuberilleFaces& faces, Direction from);
/// Binary digital array (4.4.2.1): draws back to front, slice by slice and row by row. Reads every voxel.
Projection projection(const BinaryArray& array, Direction from);
/// Runs (3.2.3): draws back to front, in the order of the list or in reverse.
Projection projection(const RunLength& runs, Direction from);
/// Segments (4.4.2.2, after Reynolds): draws front to back and stores for each row of the picture its
/// unpainted parts (the dynamic screen). Segments behind a fully painted row are not read.
Projection projection(const SegmentIndex& index, Direction from);

}  // namespace octotomy::voxel
