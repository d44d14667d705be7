// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A run of voxels: the indices first..last, both included, counted x fastest, then y, then z. A run may
/// continue across the end of a row or slice.
struct Run {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  bool operator==(const Run&) const = default;
};

/// Run length code (thesis 3.2.3): the object's maximal runs, in ascending order.
struct RunLength {
  Universe universe;
  std::vector<Run> runs;
};

/// The runs of an octree. Cost: reads the slices that are not empty, side^2 / 8 bytes each. Memory: 16 bytes
/// per run.
RunLength run_length(const Octree& octree);
/// The object of a list of runs. Throws std::invalid_argument with the run that ends before it begins, leaves
/// the universe, or begins less than two voxels after its predecessor's end. Memory: 17 slices and the
/// octree.
Octree octree_of(const RunLength& code);

/// The runs as `first:last`, for example `8:9 12:13 23:26 28:29 41:41 44:44 57:57`.
std::string text(const RunLength& code);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character; octree_of()
/// checks the runs. Memory: in proportion to the text.
RunLength parse_run_length(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
