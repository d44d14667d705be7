// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cassert>
#include <cstddef>
#include <glm/glm.hpp>

namespace octotomy::voxel {

inline std::size_t pixel_count(const glm::ivec2& size_px) {
  return static_cast<std::size_t>(size_px.x) * static_cast<std::size_t>(size_px.y);
}

/// The index of pixel (x, y) in a picture stored row by row. Precondition: the pixel lies in the picture.
inline std::size_t pixel_index(const glm::ivec2& size_px, int x, int y) {
  assert(x >= 0 && x < size_px.x && y >= 0 && y < size_px.y);
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_px.x) + static_cast<std::size_t>(x);
}

}  // namespace octotomy::voxel
