// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>

#include "voxel/grey_octree.h"
#include "voxel/octree.h"
#include "voxel/surface_scalar.h"

namespace octotomy::voxel {

/// An object to be drawn. Where `grey` is given, depth is interpolated by partial volume at `threshold`
/// (thesis 5.2.2.2), the sample at which the object begins; otherwise, and where the object ends at a cut
/// instead of at the threshold, the surface is the voxels'.
/// Precondition: `grey` is of the octree's universe, or there is a motion.
struct Drawn {
  std::string name;
  Octree octree;
  glm::vec3 colour{0.93f, 0.89f, 0.80f};  ///< sRGB, 0..1
  std::optional<GreyOctree> grey{};
  double threshold = 0.0;
  /// The rigid motion, LPS to LPS, that carried the object away from where its samples show it.
  std::optional<glm::dmat4> moved_from_still{};
  float opacity = 1.0f;  ///< 0: hidden, 1: opaque
  /// Visits are counted in the min-max octree of `grey`, its window from the threshold up, instead of in the
  /// binary octree. Precondition where set: `octree` holds just the samples of that window.
  bool counted_in_grey = false;
  /// Of an object digitised by partial volume, where `octree` holds all voxels touched: those wholly inside.
  /// Visits are then counted in the thesis's tree of it (table 3.1), where a node is Full only if wholly
  /// inside and boundary voxels are Full without being merged.
  std::optional<Octree> inside{};
  /// What colours the surface instead of `colour`, where shading knows paint (shade.h); none: nothing does.
  std::shared_ptr<const SurfaceScalar> scalar{};

  /// From the octree's voxel indices to those of the samples that show what is there now; none where both are
  /// the same. Precondition: `grey` is set.
  std::optional<glm::dmat4> still_from_voxel() const {
    if (!moved_from_still) return std::nullopt;
    return glm::inverse(*moved_from_still * grey->universe().lps_from_voxel) *
           octree.universe().lps_from_voxel;
  }
};

}  // namespace octotomy::voxel
