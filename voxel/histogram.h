// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/scene.h"

namespace octotomy::voxel {

/// How many samples lie about equally spaced values: bin i holds those nearer to low + i * width() than to
/// any other; what lies beyond is in the first and last bin.
struct Histogram {
  double low = 0.0;                   ///< the first bin's middle, in sample units
  double high = 1.0;                  ///< the last bin's middle
  std::vector<std::uint64_t> counts;  ///< at least two

  double width() const { return (high - low) / static_cast<double>(counts.size() - 1); }
  /// The value between bin - 1 and bin.
  double lower_edge(std::size_t bin) const { return low + (static_cast<double>(bin) - 0.5) * width(); }
};

/// From the 0.1st to the 99.9th percentile, so that metal and padding do not take the bins; over the whole
/// range where these are equal. Percentiles of float samples are those of a million of them. Throws
/// std::invalid_argument where there are fewer than two bins, std::runtime_error where all samples are alike.
/// Cost: two passes over the samples.
Histogram histogram(const Scene& scene, int bins = 256);

}  // namespace octotomy::voxel
