// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// A run of consecutive voxels with one value.
struct GreyRun {
  std::int16_t value = 0;
  std::uint64_t count = 0;  ///< above 0
  bool operator==(const GreyRun&) const = default;
};

/// The run length code of samples (thesis 3.2.3): maximal runs of equal values, x fastest. For a binary
/// array, runs of zeros and of ones alternate. A voxel can be located only by counting the runs before it.
using GreyRuns = std::vector<GreyRun>;

/// Cost: one pass.
GreyRuns grey_runs(std::span<const std::int16_t> samples);
/// The runs of an object: value 0 outside, 1 inside.
GreyRuns grey_runs(const Octree& octree);
/// The samples of all runs, x fastest. Throws std::invalid_argument with the run that is empty or has its
/// predecessor's value, and std::length_error if the runs contain more than `most` samples.
std::vector<std::int16_t> samples_of(const GreyRuns& runs, std::uint64_t most);

/// The runs as `(value:length)`, for example `(0:8), (1:2), (0:54)`.
std::string text(const GreyRuns& runs);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character.
GreyRuns parse_grey_runs(std::string_view text);

}  // namespace octotomy::voxel
