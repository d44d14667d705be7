// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/grey_octree.h"
#include "voxel/octree.h"

namespace octotomy::voxel {

/// Measures of a set of voxels, each voxel a solid cuboid.
struct Measures {
  std::uint64_t voxel_count = 0;
  double volume_mm3 = 0.0;
  std::optional<glm::dvec3> centroid_mm;  ///< LPS; none for an empty object
  std::optional<Box> extents;             ///< voxel edges included
  /// Area by the Crofton formula over 13 directions (Lang, Ohser, Hilfer 2001): unbiased to a few per cent on
  /// curved boundary, up to 9 % low on axis-aligned flats.
  double area_crofton13_mm2 = 0.0;
  /// Exposed voxel faces by direction (x, y, z) in square millimetres: not an area, a term of error bounds.
  glm::dvec3 exposed_mm2{0.0};
};
Measures measure(const Octree& octree);

}  // namespace octotomy::voxel
