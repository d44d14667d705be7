// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "brep/mesh/distance.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The places at which two surfaces are further apart than a limit.
struct FarPlaces {
  double largest_mm = 0.0;                                ///< over all samples, both ways
  std::vector<std::uint32_t> given_points, coarse_faces;  ///< ascending; empty: the limit holds
};

/// Measures the distances between a surface and its coarse version, both ways, in LPS millimetres: at the
/// given surface's points and the middles of its sides, and at points of the coarse surface that are no
/// farther apart than the given surface's mean side. If the middle of a side is too far, both ends of the
/// side are reported. If a coarse face is too far, the corners of the nearest given triangle are reported,
/// too. A search ends at the first distance below `enough_mm`, which is at most the limit; a `largest_mm`
/// below that is not exact. Precondition: `tree` is of `given`, both have triangles. The same answer on any
/// number of threads. Cost: n log n, parallel.
FarPlaces far_places(const Triangles& given, const SurfaceTree& tree, const Triangles& coarse,
                     double limit_mm, double enough_mm = 0.0);

/// Results of earlier measurements of one given surface: triangles, each by its corners as points of the
/// given surface.
struct NearFaces {
  std::vector<std::array<std::uint32_t, 3>> coarse;     ///< triangles of the coarse surface whose samples are
                                                        ///< all near; sorted
  std::vector<std::array<std::uint32_t, 3>> of_sample;  ///< for each sample of the given surface, the coarse
                                                        ///< triangle near it
  /// Facts about the given surface, computed by the first call: its corners in ascending order, its sides,
  /// its triangles sorted, and the mean length of its sides.
  std::vector<std::uint32_t> given_corners = {};
  std::vector<std::array<std::uint32_t, 2>> given_sides = {};
  std::vector<std::array<std::uint32_t, 3>> given_faces = {};
  double given_side_mm = 0.0;
};

/// As above, if the points of the coarse surface are points of the given one, `given_of_coarse`: measures
/// only the new parts. Triangles and sides that both surfaces have are not measured. Triangles in `near`
/// were measured before, and samples of the given surface are not searched again while the triangle near
/// them still exists. `near` must be empty before the first call; all calls must have the same given
/// surface and limit. `largest_mm` is exact only above the limit.
FarPlaces far_places(const Triangles& given, const SurfaceTree& tree, const Triangles& coarse,
                     const std::vector<std::uint32_t>& given_of_coarse, double limit_mm, NearFaces& near);

}  // namespace octotomy::brep
