// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The differences between a surface and the one from which it was made.
struct RepairEffect {
  /// For solids, the exact sum over their triangles; for other surfaces, also open ones, by line_volumes().
  double volume_before_mm3 = 0.0, volume_after_mm3 = 0.0;
  double open_line_share = 0.0;  ///< share of the lines that were left out of the volume before
  double area_before_mm2 = 0.0, area_after_mm2 = 0.0;
  /// Largest distance of the corners and middles of triangles of either surface from the other.
  double largest_distance_mm = 0.0;
  glm::dvec3 largest_at_mm{0.0};
};

/// Whether health() has found each of the two surfaces to be a solid.
struct KnownSolids {
  bool before = false, after = false;
};

/// Precondition: both have triangles. Triangles with points that are not finite are left out. Cost: n log n,
/// parallel.
RepairEffect repair_effect(const Triangles& before, const Triangles& after, const KnownSolids& solids = {});

}  // namespace octotomy::brep
