// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

struct DifferenceOptions {
  /// Of the samples that stand for the surfaces; none takes what spreads 200 000 over the larger of them, or
  /// more where long slivers would take several times as many. The Hausdorff distance is exact to it at
  /// worst, means and percentiles to a small share of it.
  std::optional<double> spacing_mm = std::nullopt;
  std::vector<double> tolerances_mm = {0.5, 1.0, 2.0};  ///< of the bands, positive and rising
  std::size_t bins = 41;  ///< of the histogram, at least 1; an odd number has one about zero
};

/// Distances from one surface's points to another's nearest point, weighted by the area they stand for.
struct OneWay {
  double mean_mm = 0.0;  ///< of the absolute distances
  double rms_mm = 0.0;
  double p95_mm = 0.0;          ///< absolute distances up to it have 95 % of the area
  double max_mm = 0.0;          ///< absolute, at samples and vertices
  double signed_mean_mm = 0.0;  ///< positive where the first surface lies outside the other
  std::vector<double> within;   ///< share of the area within each tolerance, 0..1
};

/// Shares of the area by signed distance: bin k from low_mm + k * width_mm on.
struct DistanceHistogram {
  double low_mm = 0.0, width_mm = 0.0;
  std::vector<double> shares;
};

struct Difference {
  OneWay a_to_b, b_to_a;
  double hausdorff_mm = 0.0;    ///< the larger maximum
  double hausdorff95_mm = 0.0;  ///< the larger of the two 95th percentiles
  double mean_mm = 0.0;         ///< over the areas of both
  double rms_mm = 0.0;          ///< over the areas of both
  /// The true Hausdorff distance is at most this much larger: distance changes no faster than place.
  double hausdorff_short_by_mm = 0.0;
  DistanceHistogram histogram;      ///< of a to b
  std::vector<double> vertex_mm;    ///< signed distance to b of each vertex of a
  std::size_t sample_count = 0;     ///< of both surfaces
  std::size_t on_border_count = 0;  ///< samples whose foot lies on a border, whose sign is a guess
  double spacing_mm = 0.0;          ///< largest side of a sample's triangle
};

/// How far two surfaces in the same LPS frame lie apart; point to triangle, both directions, area-weighted.
/// Signs are those of OrientedSurface. Throws std::invalid_argument where a surface has no area or an option
/// is out of its range; Error, Resource, where the spacing asks for more than 2^23 samples and four a
/// triangle of a surface. The same bits on any number of threads. Cost: n log n of samples and triangles;
/// about 0.3 s for 2 x 200 000 samples on two cores; some 80 bytes a sample. Source: Aspert et al., "MESH:
/// measuring errors between surfaces using the Hausdorff distance", ICME 2002, with percentiles.
Difference difference(const Linked& a, const Linked& b, const DifferenceOptions& options = {});
Difference difference(const Mesh& a, const Mesh& b, const DifferenceOptions& options = {});

}  // namespace octotomy::brep
