// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Counts of samples near equally spaced values: bin i counts the samples nearest to low + i * width(). The
/// first bin also counts all lower samples, the last bin all higher ones.
struct Histogram {
  double low = 0.0;                   ///< the first bin's middle, in sample units
  double high = 1.0;                  ///< the last bin's middle
  std::vector<std::uint64_t> counts;  ///< at least two

  double width() const { return (high - low) / static_cast<double>(counts.size() - 1); }
  /// The value at the border of the bins `bin` - 1 and `bin`.
  double lower_edge(std::size_t bin) const { return low + (static_cast<double>(bin) - 0.5) * width(); }
};

/// The histogram of the measured samples from the 0.1st to the 99.9th percentile, so that metal does not
/// widen the bins. If these percentiles are equal, the histogram covers the whole range. Percentiles of float
/// samples are computed from a million of them. Throws std::invalid_argument for fewer than two bins; Error
/// (Geometry) if all samples are equal. Cost: two passes over the samples.
Histogram histogram(const Scene& scene, int bins = 256);

}  // namespace octotomy::voxel
