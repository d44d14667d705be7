// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>

#include "tests/bench/picture_plane.h"

// As OpenVDB, from which it takes its grid, behind a narrow door: its unit is compiled as C++17.

namespace octotomy::bench {

/// A surface as a level set in NanoVDB, made once, seen by single rays.
class NanoVdbPeer {
 public:
  NanoVdbPeer(const FlatMesh& mesh, double voxel_mm);
  ~NanoVdbPeer();
  NanoVdbPeer(const NanoVdbPeer&) = delete;
  NanoVdbPeer& operator=(const NanoVdbPeer&) = delete;

  /// Draws a picture with a head light on the level set's gradient, in parallel over tiles of 8 x 8 pixels; 3
  /// bytes a pixel. Gives back the number of lit pixels. The surface is found to a voxel.
  int draw(const PicturePlane& plane, std::vector<std::uint8_t>& rgb) const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace octotomy::bench
