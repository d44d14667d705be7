// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"
#include "voxel/view/surface_scalar.h"

namespace octotomy::voxel {

/// An object to draw. With `grey`, depth is interpolated by partial volume at `threshold`, the sample at
/// which the object begins (thesis 5.2.2.2). Without `grey`, and on cut faces, the surface consists of
/// voxels' faces. Precondition: `grey` has the octree's universe, or `moved_from_still` is set.
struct DrawnObject {
  std::string name;
  Octree octree;
  glm::vec3 colour{0.93f, 0.89f, 0.80f};  ///< sRGB, 0..1
  std::optional<GreyOctree> grey{};
  double threshold = 0.0;
  /// The affine map, LPS to LPS, from the object's position in its samples to its position in the picture;
  /// none: not moved.
  std::optional<glm::dmat4> moved_from_still{};
  float opacity = 1.0f;  ///< 0: hidden, 1: opaque
  /// Counts visits in the min-max octree of `grey` (samples from the threshold up) instead of in the binary
  /// octree. Precondition if set: `octree` consists of the voxels with these samples.
  bool counted_in_grey = false;
  /// For an object digitised by partial volume: the voxels wholly inside it, whereas `octree` contains all
  /// voxels that the object touches. Visits are then counted in the thesis's tree for such objects (table
  /// 3.1): a node is Full only if it is wholly inside; boundary voxels count as Full but are not merged.
  std::optional<Octree> inside{};
  /// Replaces `colour` on the surface in shadings that use Paint (shade.h).
  std::shared_ptr<const SurfaceScalar> scalar{};
  /// Draws the voxels of this expression without building their octree: node tracing evaluates the expression
  /// only where it is visible. `octree` must then be empty and have the universe in which the object is
  /// drawn.
  std::optional<Expression> unbuilt{};

  /// Maps the octree's voxel indices to those of the object's samples; none if both are the same.
  /// Precondition: `grey` is set.
  std::optional<glm::dmat4> still_from_voxel() const {
    if (!moved_from_still) return std::nullopt;
    return glm::inverse(*moved_from_still * grey->universe().lps_from_voxel) *
           octree.universe().lps_from_voxel;
  }
};

/// The objects, in which each unbuilt one is replaced by its octree. Cost: combine() for each of them.
std::vector<DrawnObject> built(std::vector<DrawnObject> objects);

}  // namespace octotomy::voxel
