// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "brep/mesh/distance.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Where two surfaces lie further apart than a limit.
struct FarPlaces {
  double largest_mm = 0.0;                                ///< over all samples, both ways
  std::vector<std::uint32_t> given_points, coarse_faces;  ///< ascending; empty: the limit holds
};

/// Measures a coarse version of a surface against it, both ways, in LPS millimetres: at the given surface's
/// points and the middles of its sides, and at points of the coarse surface no further apart than the mean
/// side of the given one. Both ends of a side stand for its middle; a coarse face that is too far names the
/// corners of the given triangle nearest to it as well. A search ends at the first distance below `enough_mm`,
/// at most the limit; `largest_mm` below that need not be right. Precondition: `tree` is of `given`, both have
/// triangles. The same answer on any number of threads. Cost: n log n, parallel.
FarPlaces far_places(const Triangles& given, const SurfaceTree& tree, const Triangles& coarse,
                     double limit_mm, double enough_mm = 0.0);

}  // namespace octotomy::brep
