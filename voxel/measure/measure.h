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
  /// Surface area by the Crofton formula over 13 directions (Lang, Ohser, Hilfer 2001). Accurate to a few per
  /// cent on curved boundaries; up to 9 % too low on flat boundaries along the axes.
  double area_crofton13_mm2 = 0.0;
  /// Area by Lindblad's weighted patterns of 2 x 2 x 2 voxels (Image and Vision Computing 23, 2005): accurate
  /// to one per cent on curved boundaries, 7.3 % too low on flat boundaries along the axes. The weights are
  /// valid only for cubic voxels; none for other voxels.
  std::optional<double> area_lindblad_mm2;
  /// Inertia tensor about the centroid for a density of 1, in mm^5, along the LPS axes; none for an empty
  /// object. Multiply by a density in kg / mm^3 to get kg mm^2.
  std::optional<glm::dmat3> inertia_mm5;
  /// Area of the exposed voxel faces in square millimetres, by the axis of their normal (x, y, z). It serves
  /// for error bounds and is no estimate of the surface area.
  glm::dvec3 exposed_mm2{0.0};
};
/// Cost: two passes over the slices, word by word.
Measures measure(const Octree& octree);

/// Computes only Measures::extents. Cost: a walk over the blocks at the object's ends.
std::optional<Box> extents_of(const Octree& octree);

}  // namespace octotomy::voxel
