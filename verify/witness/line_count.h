// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "verify/witness/line_reading.h"
#include "voxel/space/progress.h"

namespace octotomy::verify {

/// Volume and area of an object, measured along lines through it.
struct LineCount {
  double volume_mm3 = 0.0;
  double deviation_mm3 = 0.0;  ///< the volume's standard deviation, from the scatter over directions
  double area_mm2 = 0.0;
  std::uint64_t lines = 0, crossings = 0;
};

struct LineCountOptions {
  std::uint64_t seed = 1;
  std::uint64_t lines = 12000;  ///< approximate; accuracy grows a little faster than the root of this number
  voxel::Box world_mm{};        ///< bounds an object that is unbounded itself
  voxel::Progress progress{};
};

/// Volume and area by the Cauchy-Crofton formula: parallel lines in twelve directions spread over a
/// hemisphere. The hemisphere is turned at random; the lines of a direction lie on a square grid with a
/// random offset. The volume is the mean over directions of the lengths inside times the area of a grid cell;
/// the area is twice the mean of the number of crossings times the area of a grid cell. Deterministic for a
/// seed, on any thread count. Throws voxel::Stopped. Cost: that of reading the lines. Precondition: `reading`
/// is not empty. Source: Santalo, Integral Geometry and Geometric Probability, 1976, chapter 14.
LineCount count_along_lines(const LineReading& reading, const LineCountOptions& options);

}  // namespace octotomy::verify
