// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

namespace octotomy::voxel {

/// What a ray of an orthographic view meets first.
struct Seen {
  float depth_mm = std::numeric_limits<float>::infinity();  ///< along look from the image plane
  std::int16_t object = -1;                                 ///< index of the object, -1: background
  bool stepped = false;  ///< the depth is a voxel's face, not interpolated by partial volume

  bool lit() const { return object >= 0; }
};

/// What every pixel sees, row by row from the top left.
struct DepthImage {
  glm::ivec2 size_px{0};
  std::vector<Seen> pixels;

  const Seen& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_px.x) +
                  static_cast<std::size_t>(x)];
  }
};

/// An image of background.
inline DepthImage unlit(const glm::ivec2& size_px) {
  return {size_px,
          std::vector<Seen>(static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y))};
}

/// Lets what `own` shows be seen where it is nearer. Precondition: images of one size.
inline void take_nearer(const DepthImage& own, DepthImage& image) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (own.pixels[i].depth_mm < image.pixels[i].depth_mm) image.pixels[i] = own.pixels[i];
}

}  // namespace octotomy::voxel
