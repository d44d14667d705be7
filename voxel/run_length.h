// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/octree.h"

namespace octotomy::voxel {

/// Voxels first..last, both included, numbered x fastest, then y, then z; rows and slices are not told apart.
struct Run {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  bool operator==(const Run&) const = default;
};

/// Run length code (thesis 3.2.3): the object's runs, each as long as it can be, in ascending order.
struct RunLength {
  Universe universe;
  std::vector<Run> runs;
};

/// Cost: the slices that hold a voxel, side^2 / 8 bytes each; 16 bytes a run.
RunLength run_length(const Octree& octree);
/// Throws std::invalid_argument naming the run that ends before it begins, leaves the universe, or does not
/// begin at least two voxels after its predecessor's end. Memory: 17 slices and the octree.
Octree octree_of(const RunLength& code);

/// `8:9 12:13 23:26 28:29 41:41 44:44 57:57`.
std::string text(const RunLength& code);
/// The inverse. Throws std::invalid_argument with the position of the character; runs are checked by
/// octree_of(). Memory: in proportion to the text.
RunLength parse_run_length(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
