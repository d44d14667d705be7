// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {

/// Builds the result of grey_octree_of() while the scene's slices are being read. Other threads build the
/// parts that the final slices determine; the result has the same bits. The scene must exist until finished()
/// or the destructor has returned. Both wait for the other threads without running unrelated tasks.
class GreyOctreeBuild {
 public:
  /// Preconditions: the scene passes check(); its vector of samples has its final size, but values may still
  /// be missing; `step` is the scene's grey_step(), which is 1 for integers that fit into 16 bits.
  GreyOctreeBuild(const Universe& universe, const Scene& scene, std::int16_t background = beyond_scan,
                  double step = 1.0);
  ~GreyOctreeBuild();
  GreyOctreeBuild(const GreyOctreeBuild&) = delete;
  GreyOctreeBuild& operator=(const GreyOctreeBuild&) = delete;

  /// Reports that the scene's first `count` slices are final. Does not wait.
  void add(int count);
  /// Waits for the other threads. Returns the share of the scan's box that has been built, from 0 to 1.
  double built();
  /// Waits for the remaining work and returns the octree. Preconditions: all slices were added, and this
  /// function was not called before. Throws as grey_octree_of() does.
  GreyOctree finished();

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace octotomy::voxel
