// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "verify/witness/reading.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {

/// The seeds and limits of growing through a scan's own samples.
struct GrownFrom {
  std::vector<glm::dvec3> seeds_mm;  ///< LPS; each begins at the nearest sample
  /// Grows through the samples in the range of the seeds' samples, widened by this tolerance at both ends. None:
  /// through the samples in low..high, both included; a seed outside low..high grows nothing.
  std::optional<double> tolerance = {};
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  int neighbours = 6;  ///< 6 by faces, 18 by edges too, 26 by corners too
  /// The largest rounding of a sample by a kernel, in the scan's unit. A sample as near as this to a bound may belong
  /// or not, and so may all samples that are reached only through such samples.
  double rounding = 0.0;
  /// With a tolerance: grows in rounds. In each, all neighbours join whose samples lie within the tolerance of the
  /// mean of the region's samples before the round. Samples are rounded to the nearest multiple of this value, halves
  /// upwards, because the mean depends on all samples and so on their rounding. None: only the seeds determine the
  /// range.
  std::optional<double> mean_of_steps = {};
};

/// The samples that a path of neighbours joins to a seed, by a flood that no kernel shares. For voxels
/// whose centres are the samples: at a sample both sides are certain, beyond the scan all is outside.
/// Elsewhere a point is certain where the eight samples about it agree. Throws std::invalid_argument
/// without seeds, for a seed beyond the scan, and for other neighbours. Cost: linear in the samples; a byte
/// for each is kept.
Witness witness_of_grown(const voxel::Scene& scan, const GrownFrom& from);

}  // namespace octotomy::verify
