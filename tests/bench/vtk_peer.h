// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>

#include "tests/bench/picture_plane.h"

namespace octotomy::bench {

/// A scan in VTK's fixed-point volume ray caster: opaque from a threshold, shaded by gradients that are
/// computed once, a step a voxel. The image stays in memory; nothing is sent to a screen.
class VtkPeer {
 public:
  VtkPeer(const FlatScan& scan, double threshold, int threads);
  ~VtkPeer();
  VtkPeer(const VtkPeer&) = delete;
  VtkPeer& operator=(const VtkPeer&) = delete;

  /// Draws a picture and returns the number of lit pixels.
  int draw(const PicturePlane& plane) const;

 private:
  struct Pipeline;
  std::unique_ptr<Pipeline> pipeline_;
};

}  // namespace octotomy::bench
