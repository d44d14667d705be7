// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Measures of a set of voxels, each voxel a solid cuboid.
struct Measures {
  std::uint64_t voxel_count = 0;
  double volume_mm3 = 0.0;
  std::optional<glm::dvec3> centroid_mm;  ///< LPS; none for an empty object
  std::optional<Box> extents;             ///< voxel edges included
  /// Area by the Crofton formula over 13 directions (Lang, Ohser, Hilfer 2001): within a few per cent on
  /// curved boundary, up to 9 % low on axis-aligned flats.
  double area_crofton13_mm2 = 0.0;
  /// Area by Lindblad's weighted patterns of 2 x 2 x 2 voxels (Image and Vision Computing 23, 2005): within
  /// one per cent on curved boundary, 7.3 % low on axis-aligned flats. The weights hold for cubic voxels;
  /// none for others.
  std::optional<double> area_lindblad_mm2;
  /// Inertia tensor about the centroid for a density of 1, in mm^5, along the LPS axes; none for an empty
  /// object. Multiply by a density in kg / mm^3 to get kg mm^2.
  std::optional<glm::dmat3> inertia_mm5;
  /// Area of the exposed voxel faces by axis (x, y, z) in square millimetres, for error bounds; not an
  /// estimate of the area.
  glm::dvec3 exposed_mm2{0.0};
};
/// Cost: two walks over the slices, word by word.
Measures measure(const Octree& octree);

/// Only Measures::extents. Cost: a walk over the blocks at the object's ends.
std::optional<Box> extents_of(const Octree& octree);

}  // namespace octotomy::voxel
