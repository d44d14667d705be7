// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "voxel/camera.h"
#include "voxel/depth_image.h"
#include "voxel/drawn.h"

namespace octotomy::voxel {

/// Casts rays of any view, made ready for one image plane. Copies share; any number of threads may cast.
class RayCast {
 public:
  /// Precondition: one object at least, all of one universe, that of the plane.
  /// Cost: a table of a thousand words.
  RayCast(const std::vector<Drawn>& objects, const ImagePlane& plane);

  /// What the ray through a pixel position meets first: the nearest surface of any object, the first object
  /// listed where several are equally near. With Drawn::grey the surface is where trilinear samples cross
  /// the threshold near a voxel of the object, and a ray that only clips voxels outside that surface goes on;
  /// where a voxel of the object borders on one that was cut away, it is the voxel's face. A ray through
  /// voxel centres along an axis meets what node_trace() finds in that column.
  /// Cost: one step for every homogeneous block passed.
  Seen seen(const glm::dvec2& p_px) const;
  /// The same between two depths only; what begins before or behind them is passed over.
  Seen seen(const glm::dvec2& p_px, double near_mm, double far_mm) const;
  /// What the centres of all pixels see. Parallel over squares of pixels, whose rays pass the octrees
  /// together; seen by an eye at a finite distance each ray goes its own way, which takes about ten times as
  /// long.
  DepthImage picture() const;

  struct Prepared;

 private:
  std::shared_ptr<const Prepared> prepared_;
};

}  // namespace octotomy::voxel
