// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>

#include "tests/bench/picture_plane.h"

namespace octotomy::bench {

/// A triangle mesh in Embree, whose hierarchy is built once. It is traced by coherent packets of sixteen
/// rays.
class EmbreePeer {
 public:
  explicit EmbreePeer(const FlatMesh& mesh);
  ~EmbreePeer();
  EmbreePeer(const EmbreePeer&) = delete;
  EmbreePeer& operator=(const EmbreePeer&) = delete;

  /// Draws a picture with a head light on flat triangles, in parallel over tiles of 4 x 4 pixels; 3 bytes a
  /// pixel. Returns the number of lit pixels.
  int draw(const PicturePlane& plane, std::vector<std::uint8_t>& rgb) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace octotomy::bench
