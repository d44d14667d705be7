// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Every outline has an edge above one of its pixels. From each such edge that belongs to no outline yet, a
// walk follows the edges with set pixels on its right. At a corner it turns right if the right pixel ahead is
// unset, turns left if both pixels ahead are set, and else goes straight.
#include "voxel/archive/pixel_outlines.h"

namespace octotomy::voxel {
namespace {

/// A slice's pixels; pixels beyond the slice read as unset.
class Pixels {
 public:
  explicit Pixels(const SliceBits& slice) : slice_(slice) {}

  int side() const { return slice_.side; }
  bool is_set(const glm::ivec2& p) const {
    if (p.x < 0 || p.y < 0 || p.x >= slice_.side || p.y >= slice_.side) return false;
    return ((slice_.row(p.y)[p.x / 64] >> (p.x % 64)) & 1) != 0;
  }

 private:
  const SliceBits& slice_;
};

/// A walk along pixels' edges arrives at a corner with the step `way`. Returns the right one of the two
/// pixels ahead.
glm::ivec2 right_ahead(const glm::ivec2& corner, const glm::ivec2& way) {
  // For a step along +x this pixel has the corner's indices; the other directions follow by quarter turns.
  return corner + glm::ivec2((way.x - way.y - 1) / 2, (way.x + way.y - 1) / 2);
}
glm::ivec2 left_ahead(const glm::ivec2& corner, const glm::ivec2& way) {
  return corner + glm::ivec2((way.x + way.y - 1) / 2, (way.y - way.x - 1) / 2);
}

/// The outline that contains the edge above the given pixel. Marks in `is_done` all pixels whose upper edge
/// is on this outline.
PixelOutline outline_from(const Pixels& pixels, const glm::ivec2& pixel, std::vector<bool>& is_done) {
  PixelOutline outline;
  glm::ivec2 corner = pixel, way(1, 0);
  do {
    if (way == glm::ivec2(1, 0))
      is_done[static_cast<std::size_t>(corner.y) * static_cast<std::size_t>(pixels.side()) +
              static_cast<std::size_t>(corner.x)] = true;
    corner += way;
    const glm::ivec2 before = way;
    if (!pixels.is_set(right_ahead(corner, way)))
      way = {-way.y, way.x};
    else if (pixels.is_set(left_ahead(corner, way)))
      way = {way.y, -way.x};
    if (way != before) outline.push_back(corner);
  } while (corner != pixel || way != glm::ivec2(1, 0));
  return outline;
}

}  // namespace

std::vector<PixelOutline> pixel_outlines(const SliceBits& slice) {
  const Pixels pixels(slice);
  std::vector<bool> is_done(static_cast<std::size_t>(slice.side) * static_cast<std::size_t>(slice.side));
  std::vector<PixelOutline> outlines;
  for (int y = 0; y < slice.side; ++y)
    for (int word = 0; word < slice.words_per_row; ++word) {
      if (slice.row(y)[word] == 0) continue;
      for (int x = 64 * word; x < std::min(64 * (word + 1), slice.side); ++x)
        if (pixels.is_set({x, y}) && !pixels.is_set({x, y - 1}) &&
            !is_done[static_cast<std::size_t>(y) * static_cast<std::size_t>(slice.side) +
                     static_cast<std::size_t>(x)])
          outlines.push_back(outline_from(pixels, {x, y}, is_done));
    }
  return outlines;
}

long long doubled_area(const PixelOutline& outline) {
  long long sum = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::ivec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    sum += static_cast<long long>(a.x) * b.y - static_cast<long long>(b.x) * a.y;
  }
  return sum;
}

}  // namespace octotomy::voxel
