// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/partial_volume.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <tbb/parallel_for.h>
#include <vector>

#include "voxel/solid/status_within.h"

// A cell is the cube between eight neighbouring voxel centres. Cells are taken in blocks of 16 x 16 x 16 by
// their first corner; blocks one before the universe's first hold the cells that reach into it from outside.
// Passes: 1 each block sums the shares of its cells, most settled by the range of samples it can see; 2 the
// blocks' sums are added in order.

namespace octotomy::voxel {
namespace {

constexpr int block_side = 16;
constexpr int corner_side = block_side + 1;
constexpr int lines_an_axis = 4;

// Length of the part of 0..1 over which a value that changes linearly from `from` to `to` lies in the window.
double length_within(double from, double to, double low, double high) {
  if (from > to) std::swap(from, to);
  const double above = std::max(low, from);
  const double below = std::min(high, to);
  if (above > below) return 0.0;
  return to > from ? (below - above) / (to - from) : 1.0;
}

// Which of the 8 corners of a cell, x + 2y + 4z, are the scan's.
using CornerBits = std::uint8_t;
constexpr CornerBits all_corners = 0xff;

class BlockSum {
 public:
  explicit BlockSum(const Window& window) : grey_(window.grey), low_(window.low), high_(window.high) {}

  // Cells' volumes, in voxels, of block number `block`, -1 and up.
  double operator()(const glm::ivec3& block) const {
    const MinMax range = range_around(block);
    if (range.high < low_ || range.low > high_) return 0.0;
    const glm::ivec3 first = block_side * block;
    const Status scanned = status_within(grey_.scan(), {first, first + block_side});
    if (scanned == Status::Empty) return 0.0;
    if (scanned == Status::Full && range.low >= low_ && range.high <= high_)
      return block_side * block_side * block_side;
    std::array<std::int16_t, corner_side * corner_side * corner_side> corners;
    fetch(block, corners);
    double sum = 0.0;
    for (int z = 0; z < block_side; ++z)
      for (int y = 0; y < block_side; ++y)
        for (int x = 0; x < block_side; ++x)
          sum += share(&corners[index(x, y, z)],
                       scanned == Status::Full ? all_corners : scanned_corners(first + glm::ivec3(x, y, z)));
    return sum;
  }

 private:
  static std::size_t index(int x, int y, int z) {
    return static_cast<std::size_t>(x + corner_side * (y + corner_side * z));
  }

  // Range of the samples at the corners of a block's cells: its own voxels and the first of the next blocks.
  MinMax range_around(const glm::ivec3& block) const {
    const int blocks = (grey_.universe().side() + block_side - 1) / block_side;
    MinMax range{grey_.background(), grey_.background()};
    bool any = false;
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 at = block + glm::ivec3(k & 1, (k >> 1) & 1, k >> 2);
      const bool outside = glm::any(glm::lessThan(at, glm::ivec3(0))) ||
                           glm::any(glm::greaterThanEqual(at, glm::ivec3(blocks)));
      const MinMax part = outside ? MinMax{grey_.background(), grey_.background()} : grey_.range(2, at);
      if (any)
        range.widen(part);
      else
        range = part;
      any = true;
    }
    return range;
  }

  void fetch(const glm::ivec3& block,
             std::array<std::int16_t, corner_side * corner_side * corner_side>& corners) const {
    for (int z = 0; z < corner_side; ++z)
      for (int y = 0; y < corner_side; ++y)
        for (int x = 0; x < corner_side; ++x)
          corners[index(x, y, z)] = grey_.sample(block_side * block + glm::ivec3(x, y, z));
  }

  CornerBits scanned_corners(const glm::ivec3& first) const {
    unsigned bits = 0;
    for (int k = 0; k < 8; ++k)
      bits |= static_cast<unsigned>(grey_.scan().contains(first + glm::ivec3(k & 1, (k >> 1) & 1, k >> 2)))
              << k;
    return static_cast<CornerBits>(bits);
  }

  // The part of a cell in the window and in the scan; `corner` is its first one.
  double share(const std::int16_t* corner, CornerBits scanned) const {
    constexpr int along_y = corner_side;
    constexpr int along_z = corner_side * corner_side;
    const std::array<double, 8> c{static_cast<double>(corner[0]),
                                  static_cast<double>(corner[1]),
                                  static_cast<double>(corner[along_y]),
                                  static_cast<double>(corner[along_y + 1]),
                                  static_cast<double>(corner[along_z]),
                                  static_cast<double>(corner[along_z + 1]),
                                  static_cast<double>(corner[along_z + along_y]),
                                  static_cast<double>(corner[along_z + along_y + 1])};
    const auto [least, most] = std::minmax_element(c.begin(), c.end());
    if (*most < low_ || *least > high_) return 0.0;
    if (*least >= low_ && *most <= high_) return std::popcount(scanned) / 8.0;
    double sum = 0.0;
    for (int j = 0; j < lines_an_axis; ++j)
      for (int i = 0; i < lines_an_axis; ++i) {
        const double s = (i + 0.5) / lines_an_axis;
        const double t = (j + 0.5) / lines_an_axis;
        const auto at = [&](std::size_t k) {
          const double near = c[k] + s * (c[k + 1] - c[k]);
          const double far = c[k + 2] + s * (c[k + 3] - c[k + 2]);
          return near + t * (far - near);
        };
        if (scanned == all_corners) {
          sum += length_within(at(0), at(4), low_, high_);
          continue;
        }
        // Either half of the line is nearest to one corner.
        const int nearest = (i < lines_an_axis / 2 ? 0 : 1) + (j < lines_an_axis / 2 ? 0 : 2);
        const double middle = 0.5 * (at(0) + at(4));
        if ((scanned >> nearest) & 1) sum += 0.5 * length_within(at(0), middle, low_, high_);
        if ((scanned >> (nearest + 4)) & 1) sum += 0.5 * length_within(middle, at(4), low_, high_);
      }
    return sum / (lines_an_axis * lines_an_axis);
  }

  const GreyOctree& grey_;
  double low_, high_;
};

}  // namespace

double partial_volume_mm3(const Window& window) {
  const int blocks = (window.grey.universe().side() + block_side - 1) / block_side + 1;
  const auto count = static_cast<std::size_t>(blocks);
  std::vector<double> sums(count * count * count);
  const BlockSum sum(window);
  tbb::parallel_for(std::size_t{0}, count * count, [&](std::size_t row) {
    for (std::size_t x = 0; x < count; ++x)
      sums[row * count + x] = sum(glm::ivec3(x, row % count, row / count) - 1);
  });
  double voxels = 0.0;
  for (const double block : sums) voxels += block;
  return voxels * window.grey.universe().lattice().voxel_mm3();
}

}  // namespace octotomy::voxel
