// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cassert>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <type_traits>
#include <vector>

#include "voxel/space/large_allocator.h"
#include "voxel/view/pixel_index.h"

namespace octotomy::voxel {

/// The surface that a line of sight meets first, or background.
struct Seen {
  /// Depth along look from the image plane; infinity: background.
  float depth_mm = std::numeric_limits<float>::infinity();
  std::int16_t object = -1;  ///< index of the object, -1: background
  /// Whether the depth is that of a voxel's face instead of interpolated by partial volume.
  bool stepped = false;

  bool lit() const { return object >= 0; }
};

/// Does not initialise pixels that are constructed without a value, so that only the threads that compute
/// pixels write them. A Seen is an aggregate that may be copied bytewise, so its memory needs no constructor.
struct PixelAllocator : LargeAllocator<Seen> {
  template <typename Other>
  struct rebind {  // NOLINT(readability-identifier-naming): the standard fixes this name
    using other = PixelAllocator;
  };
  using LargeAllocator<Seen>::construct;
  void construct(Seen*) { static_assert(std::is_aggregate_v<Seen> && std::is_trivially_copyable_v<Seen>); }
};

/// The surface at every pixel, row by row from the top left.
struct DepthImage {
  glm::ivec2 size_px{0};
  std::vector<Seen, PixelAllocator> pixels;

  const Seen& at(int x, int y) const { return pixels[pixel_index(size_px, x, y)]; }
};

/// An image whose pixels are uninitialised.
inline DepthImage unset(const glm::ivec2& size_px) {
  DepthImage image{size_px, {}};
  image.pixels.resize(pixel_count(size_px));
  return image;
}

/// An image of background.
inline DepthImage unlit(const glm::ivec2& size_px) {
  DepthImage image{size_px, {}};
  image.pixels.assign(pixel_count(size_px), Seen{});
  return image;
}

/// Overwrites the pixels of `image` at which `own` is nearer. Precondition: both images have the same size.
inline void take_nearer(const DepthImage& own, DepthImage& image) {
  assert(own.pixels.size() == image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    if (own.pixels[i].depth_mm < image.pixels[i].depth_mm) image.pixels[i] = own.pixels[i];
}

}  // namespace octotomy::voxel
