// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>

#include "tests/bench/picture_plane.h"

// An interface without NanoVDB's headers, because its unit is compiled as C++17. The grid comes from OpenVDB.

namespace octotomy::bench {

/// A surface as a level set in NanoVDB, built once and traced by single rays.
class NanoVdbPeer {
 public:
  NanoVdbPeer(const FlatMesh& mesh, double voxel_mm);
  ~NanoVdbPeer();
  NanoVdbPeer(const NanoVdbPeer&) = delete;
  NanoVdbPeer& operator=(const NanoVdbPeer&) = delete;

  /// Draws a picture with a head light on the level set's gradient, in parallel over tiles of 8 x 8 pixels; 3
  /// bytes a pixel. Returns the number of lit pixels. The surface is located to a voxel.
  int draw(const PicturePlane& plane, std::vector<std::uint8_t>& rgb) const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace octotomy::bench
