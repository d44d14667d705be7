// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "verify/witness/line_reading.h"
#include "voxel/space/progress.h"

namespace octotomy::verify {

/// Volume and area of an object, measured along lines through it.
struct LineCount {
  double volume_mm3 = 0.0;
  double deviation_mm3 = 0.0;  ///< standard deviation of the volume, from the scatter over directions
  double area_mm2 = 0.0;
  std::uint64_t lines = 0, crossings = 0;
};

struct LineCountOptions {
  std::uint64_t seed = 1;
  std::uint64_t lines = 12000;  ///< approximate; accuracy grows a little faster than the root of it
  voxel::Box world_mm{};        ///< replaces the infinite sides of the object's box
  voxel::Progress progress{};
};

/// Measures volume and area by the Cauchy-Crofton formula, along parallel lines in twelve directions that are
/// spread over a hemisphere. The hemisphere is turned at random. The lines of a direction lie on a square
/// grid with a random offset. The volume is the mean over directions of the total length inside times the
/// area of a grid cell. The area is twice the mean number of crossings times the area of a grid cell.
/// Deterministic for a seed, on any thread count. Throws voxel::Stopped. Cost: that of reading the lines.
/// Precondition: `reading` is not empty. Source: Santalo, Integral Geometry and Geometric Probability, 1976,
/// chapter 14.
LineCount count_along_lines(const LineReading& reading, const LineCountOptions& options);

}  // namespace octotomy::verify
