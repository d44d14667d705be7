// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "verify/witness/line_reading.h"
#include "voxel/space/progress.h"

namespace octotomy::verify {

/// Amounts of an object by lines through it.
struct LineCount {
  double volume_mm3 = 0.0;
  double deviation_mm3 = 0.0;  ///< the volume's standard deviation, from the scatter over directions
  double area_mm2 = 0.0;
  std::uint64_t lines = 0, crossings = 0;
};

struct LineCountOptions {
  std::uint64_t seed = 1;
  std::uint64_t lines = 12000;  ///< about so many: accuracy grows a little faster than with their root
  voxel::Box world_mm{};        ///< where an object without an end of its own ends
  voxel::Progress progress{};
};

/// Volume and area by the Cauchy-Crofton formula: parallel lines in twelve directions spread over a
/// hemisphere, turned as a whole by chance; in each direction on a square grid whose place is chance, too.
/// The volume is the mean over directions of the lengths inside times the grid's cell, the area twice that of
/// the crossings. Deterministic for a seed, on any thread count. Throws voxel::Stopped. Cost: that of reading
/// the lines. Precondition: `reading` is not empty. Source: Santalo, Integral Geometry and Geometric
/// Probability, 1976, chapter 14.
LineCount count_along_lines(const LineReading& reading, const LineCountOptions& options);

}  // namespace octotomy::verify
