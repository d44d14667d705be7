// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {

/// Builds grey_octree_of() a scene while its slices become final: other threads build what the first ones
/// determine, the bits are the same. Refers to the scene until it is finished or gone; either waits for the
/// other threads and takes up no other work meanwhile.
class GreyOctreeBuild {
 public:
  /// Preconditions: the scene passes check(); its samples need no values yet, but their place; `step` is
  /// their grey_step(), which of whole numbers of 16 bits is 1.
  GreyOctreeBuild(const Universe& universe, const Scene& scene, std::int16_t background = beyond_scan,
                  double step = 1.0);
  ~GreyOctreeBuild();
  GreyOctreeBuild(const GreyOctreeBuild&) = delete;
  GreyOctreeBuild& operator=(const GreyOctreeBuild&) = delete;

  /// The scene's first `count` slices are final. Does not wait.
  void add(int count);
  /// Waits for the other threads and tells what share of the voxels in the scan's box they have built.
  double built();
  /// Precondition: all slices were added. Throws as grey_octree_of(). To be called once.
  GreyOctree finished();

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace octotomy::voxel
