// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
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

/// What earlier measurements of one given surface hold on: triangles, by the given points of their corners,
/// ascending.
struct NearFaces {
  std::vector<std::array<std::uint32_t, 3>> coarse;     ///< sorted; all of their samples are near
  std::vector<std::array<std::uint32_t, 3>> of_sample;  ///< near each sample of the given surface
};

/// The same where the points of the coarse surface are points of the given one, `given_of_coarse`: measures
/// only where it is new. Triangles and sides of the given surface that are still there lie on it; triangles in
/// `near` were measured before, and samples of the given surface need no search while the triangle near them
/// is still there. `near` is empty before the first call, and of the same given surface and limit in all.
/// `largest_mm` is right above the limit only.
FarPlaces far_places(const Triangles& given, const SurfaceTree& tree, const Triangles& coarse,
                     const std::vector<std::uint32_t>& given_of_coarse, double limit_mm, NearFaces& near);

}  // namespace octotomy::brep
