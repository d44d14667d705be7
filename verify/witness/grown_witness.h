// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "verify/witness/reading.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {

/// The seeds and the limits of a region that grows through a scan's own samples.
struct GrownFrom {
  std::vector<glm::dvec3> seeds_mm;  ///< LPS; a seed stands for the sample nearest to it
  /// Tolerance: the region grows through samples in the range of the seeds' samples, widened by this amount
  /// at both ends. None: it grows through samples in low..high, both included, and a seed whose sample is
  /// outside low..high grows nothing.
  std::optional<double> tolerance = {};
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  int neighbours = 6;  ///< 6 by faces, 18 by edges too, 26 by corners too
  /// The largest rounding of a sample by a kernel, in the scan's unit. A sample within this distance of a
  /// bound may belong to the region or not. The same applies to all samples that are reached only through
  /// such samples.
  double rounding = 0.0;
  /// Used with a tolerance: the region grows in rounds. In each round all neighbours join whose samples lie
  /// within the tolerance of the mean of the region's samples before the round. Samples are rounded to the
  /// nearest multiple of this value, halves upwards, because the mean depends on the rounding of all samples.
  /// None: the seeds alone determine the range.
  std::optional<double> mean_of_steps = {};
};

/// A witness of the samples that a path of neighbours joins to a seed. No kernel shares its flood. For voxels
/// whose centres are the samples: at a sample both sides are certain, and beyond the scan all is outside.
/// Elsewhere a point is certain where the eight samples about it agree. Throws std::invalid_argument without
/// seeds, for a seed outside the scan, and unless there are 6, 18 or 26 neighbours. Cost: linear in the
/// samples; memory: one byte a sample.
Witness witness_of_grown(const voxel::Scene& scan, const GrownFrom& from);

}  // namespace octotomy::verify
