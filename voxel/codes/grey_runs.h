// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Neighbouring voxels of one value.
struct GreyRun {
  std::int16_t value = 0;
  std::uint64_t count = 0;  ///< above 0
  bool operator==(const GreyRun&) const = default;
};

/// The run length code of samples (thesis 3.2.3): maximal runs of equal values, x fastest. For a binary
/// array, runs of zeros and of ones alternate. No voxel can be read without its predecessors.
using GreyRuns = std::vector<GreyRun>;

/// Cost: one pass.
GreyRuns grey_runs(std::span<const std::int16_t> samples);
/// The runs of 0 outside and 1 inside.
GreyRuns grey_runs(const Octree& octree);
/// The samples. Throws std::invalid_argument that names the run which is empty or continues its predecessor,
/// and std::length_error if there would be more than `most` samples.
std::vector<std::int16_t> samples_of(const GreyRuns& runs, std::uint64_t most);

/// For example `(0:8), (1:2), (0:54)`.
std::string text(const GreyRuns& runs);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character.
GreyRuns parse_grey_runs(std::string_view text);

}  // namespace octotomy::voxel
