// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/depth_image.h"
#include "voxel/view/drawn_object.h"

namespace octotomy::voxel {

/// Casts the rays of one image plane of any view. Copies share their data; any number of threads may cast.
class RayCast {
 public:
  /// Precondition: there is at least one object, and all have the plane's universe. Cost: computes a table of
  /// a thousand words.
  RayCast(const std::vector<DrawnObject>& objects, const ImagePlane& plane);

  /// The nearest surface of any object on the ray through a pixel position; at equal depth, that of the first
  /// object. With DrawnObject::grey the surface is the crossing of the threshold by trilinear samples near a
  /// voxel of the object; a ray that passes voxels but remains outside this surface continues. Next to a
  /// voxel that was cut away, the surface is the voxel's face. A ray through voxel centres along an axis
  /// meets the surface that node_trace() finds in that column. Cost: one step for every homogeneous block on
  /// the ray.
  Seen seen(const glm::dvec2& p_px) const;
  /// The nearest surface between two depths; surfaces in front of and behind these are ignored.
  Seen seen(const glm::dvec2& p_px, double near_mm, double far_mm) const;
  /// The surfaces at the centres of all pixels. Parallel over squares of pixels; the rays of a square share
  /// one walk through each octree. With an eye at a finite distance the rays walk one by one, which takes
  /// about ten times as long.
  DepthImage picture() const;

  struct Prepared;

 private:
  std::shared_ptr<const Prepared> prepared_;
};

}  // namespace octotomy::voxel
