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
/// voxels' faces. Precondition: `grey` is of the octree's universe, or `moved_from_still` is set.
struct DrawnObject {
  std::string name;
  Octree octree;
  glm::vec3 colour{0.93f, 0.89f, 0.80f};  ///< sRGB, 0..1
  std::optional<GreyOctree> grey{};
  double threshold = 0.0;
  /// The motion, affine, LPS to LPS, from the object's place in its samples to its place in the picture.
  std::optional<glm::dmat4> moved_from_still{};
  float opacity = 1.0f;  ///< 0: hidden, 1: opaque
  /// Counts visits in the min-max octree of `grey` (samples from the threshold up) instead of in the binary
  /// octree. Precondition if set: `octree` holds the voxels with these samples.
  bool counted_in_grey = false;
  /// For an object digitised by partial volume: the voxels wholly inside it, while `octree` holds all voxels
  /// that it touches. Visits are then counted in the thesis's tree for such objects (table 3.1): a node is
  /// Full only if wholly inside, and boundary voxels are Full without being merged.
  std::optional<Octree> inside{};
  /// Colours the surface instead of `colour` in shadings that use Paint (shade.h).
  std::shared_ptr<const SurfaceScalar> scalar{};
  /// Draws the voxels of this expression without building their octree: node tracing evaluates the expression
  /// only where it is visible. `octree` is then empty and of the universe to draw in.
  std::optional<Expression> unbuilt{};

  /// Maps the octree's voxel indices to those of the object's samples; none if both are the same.
  /// Precondition: `grey` is set.
  std::optional<glm::dmat4> still_from_voxel() const {
    if (!moved_from_still) return std::nullopt;
    return glm::inverse(*moved_from_still * grey->universe().lps_from_voxel) *
           octree.universe().lps_from_voxel;
  }
};

/// The objects, with an octree built for each unbuilt one. Cost: combine() for each of these.
std::vector<DrawnObject> built(std::vector<DrawnObject> objects);

}  // namespace octotomy::voxel
