// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/partial_volume.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <tbb/parallel_for.h>
#include <vector>

#include "voxel/solid/status_within.h"
#include "voxel/space/vector_clones.h"

// A cell is the cube between eight neighbouring voxel centres. Cells are processed in blocks of 16 x 16 x 16,
// numbered by their first corner. Blocks with an index of -1 contain the cells that reach into the universe
// from outside. Passes: 1 each block sums the shares of its cells; for most cells the range of the samples
// already decides the share; 2 the blocks' sums are added in order.

namespace octotomy::voxel {
namespace {

constexpr int block_side = 16;
constexpr int corner_side = block_side + 1;
constexpr int lines_an_axis = 4;

// A value changes linearly from `from` at 0 to `to` at 1. Returns the length of the part of 0..1 in which it
// lies in the window. There are no branches, so that the compiler vectorises the function.
double length_within(double from, double to, double low, double high) {
  const double first = from > to ? to : from;
  const double last = from > to ? from : to;
  const double above = low < first ? first : low;
  const double below = last < high ? last : high;
  const double length = last > first ? (below - above) / (last - first) : 1.0;
  return above > below ? 0.0 : length;
}

constexpr int line_count = lines_an_axis * lines_an_axis;

// The values at both ends of each of a cell's lines along z, and the length of each line's part in the
// window.
struct Lines {
  std::array<double, line_count> from, to, length;
};
OCTOTOMY_VECTOR_CLONES void find_lines(const std::array<double, 8>& c, double low, double high,
                                       Lines& lines) {
  for (int line = 0; line < line_count; ++line) {
    const double s = (line % lines_an_axis + 0.5) / lines_an_axis;
    const double t = (line / lines_an_axis + 0.5) / lines_an_axis;
    const auto at = [&](std::size_t k) {
      const double near = c[k] + s * (c[k + 1] - c[k]);
      const double far = c[k + 2] + s * (c[k + 3] - c[k + 2]);
      return near + t * (far - near);
    };
    const auto i = static_cast<std::size_t>(line);
    lines.from[i] = at(0);
    lines.to[i] = at(4);
  }
  for (std::size_t i = 0; i < line_count; ++i)
    lines.length[i] = length_within(lines.from[i], lines.to[i], low, high);
}

// The samples at the corners of a block's cells, x fastest.
using Corners = std::array<std::int16_t, corner_side * corner_side * corner_side>;

// The least and the greatest sample of each cell's corners, stored at the cell's first corner.
OCTOTOMY_VECTOR_CLONES void find_cell_ranges(const Corners& corners, Corners& low, Corners& high) {
  low = high = corners;
  for (const std::size_t step : {1, corner_side, corner_side * corner_side})
    for (std::size_t i = 0; i + step < corners.size(); ++i) {
      low[i] = low[i + step] < low[i] ? low[i + step] : low[i];
      high[i] = high[i + step] > high[i] ? high[i + step] : high[i];
    }
}

// A mask of a cell's corners that belong to the scan; corner number x + 2y + 4z.
using CornerBits = std::uint8_t;
constexpr CornerBits all_corners = 0xff;

// Sets each corner of a cell outside the scan to the mean of its nearest corners in the scan. So the scan's
// last samples extend their values by up to half a sample, as in interpolated surfaces.
void extend(std::array<double, 8>& c, CornerBits scanned) {
  const std::array<double, 8> own = c;
  for (unsigned k = 0; k < 8; ++k) {
    if ((scanned >> k) & 1) continue;
    double sum = 0.0;
    int count = 0;
    for (int edges = 1; edges <= 3 && count == 0; ++edges)
      for (unsigned j = 0; j < 8; ++j) {
        if (((scanned >> j) & 1) == 0 || std::popcount(j ^ k) != edges) continue;
        sum += own[j];
        ++count;
      }
    if (count > 0) c[k] = sum / count;
  }
}

class BlockSum {
 public:
  explicit BlockSum(const Window& window) : grey_(window.grey), low_(window.low), high_(window.high) {}

  // The volume of the window, in voxels, in the block with index `block`, whose coordinates are -1 or more.
  double operator()(const glm::ivec3& block) const {
    const MinMax range = range_around(block);
    if (range.high < low_ || range.low > high_) return 0.0;
    const glm::ivec3 first = block_side * block;
    const Status scanned = status_within(grey_.scan(), {first, first + block_side});
    if (scanned == Status::Empty) return 0.0;
    if (scanned == Status::Full && range.low >= low_ && range.high <= high_)
      return block_side * block_side * block_side;
    Corners corners, low, high;
    fetch(block, corners);
    find_cell_ranges(corners, low, high);
    double sum = 0.0;
    for (int z = 0; z < block_side; ++z)
      for (int y = 0; y < block_side; ++y)
        for (int x = 0; x < block_side; ++x) {
          const std::size_t cell = index(x, y, z);
          if (high[cell] < low_ || low[cell] > high_) continue;
          const CornerBits of_scan =
              scanned == Status::Full ? all_corners : scanned_corners(first + glm::ivec3(x, y, z));
          const bool is_full = low[cell] >= low_ && high[cell] <= high_;
          sum += is_full ? std::popcount(of_scan) / 8.0 : share(&corners[cell], of_scan);
        }
    return sum;
  }

 private:
  static std::size_t index(int x, int y, int z) {
    return static_cast<std::size_t>(x + corner_side * (y + corner_side * z));
  }

  // The range of the samples at the corners of a block's cells: the block's voxels and the first voxels of
  // the next blocks.
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

  // Copies the corners' samples, up to four of a brick at a time. The last corner of a row is the first
  // sample of the next brick.
  void fetch(const glm::ivec3& block, Corners& corners) const {
    const int blocks = (grey_.universe().side() + block_side - 1) / block_side;
    for (int next = 0; next < 8; ++next) {
      const glm::ivec3 by(next & 1, (next >> 1) & 1, next >> 2), at = block + by;
      const bool outside = glm::any(glm::lessThan(at, glm::ivec3(0))) ||
                           glm::any(glm::greaterThanEqual(at, glm::ivec3(blocks)));
      const GreyBrick* const brick = outside ? nullptr : &grey_.brick(at);
      const glm::ivec3 count = block_side - (block_side - 1) * by;
      for (int z = 0; z < count.z; ++z)
        for (int y = 0; y < count.y; ++y)
          for (int x = 0; x < count.x; x += 4) {
            std::int16_t* const to =
                &corners[index(block_side * by.x + x, block_side * by.y + y, block_side * by.z + z)];
            const int width = std::min(4, count.x);
            if (brick == nullptr)
              std::fill_n(to, width, grey_.background());
            else
              std::copy_n(&brick->samples[static_cast<std::size_t>(child_index(x >> 2, y >> 2, z >> 2))]
                                         [static_cast<std::size_t>(child_index(0, y & 3, z & 3))],
                          width, to);
          }
    }
  }

  CornerBits scanned_corners(const glm::ivec3& first) const {
    unsigned bits = 0;
    for (int k = 0; k < 8; ++k)
      bits |= static_cast<unsigned>(grey_.scan().contains(first + glm::ivec3(k & 1, (k >> 1) & 1, k >> 2)))
              << k;
    return static_cast<CornerBits>(bits);
  }

  // The share of a cell that lies in the window and in the scan; `corner` is its first corner. Called for
  // cells with corners inside and outside the window.
  double share(const std::int16_t* corner, CornerBits scanned) const {
    constexpr int along_y = corner_side;
    constexpr int along_z = corner_side * corner_side;
    std::array<double, 8> c{static_cast<double>(corner[0]),
                            static_cast<double>(corner[1]),
                            static_cast<double>(corner[along_y]),
                            static_cast<double>(corner[along_y + 1]),
                            static_cast<double>(corner[along_z]),
                            static_cast<double>(corner[along_z + 1]),
                            static_cast<double>(corner[along_z + along_y]),
                            static_cast<double>(corner[along_z + along_y + 1])};
    if (scanned != all_corners) extend(c, scanned);
    Lines lines;
    find_lines(c, low_, high_, lines);
    double sum = 0.0;
    for (int line = 0; line < line_count; ++line) {
      const auto i = static_cast<std::size_t>(line);
      if (scanned == all_corners) {
        sum += lines.length[i];
        continue;
      }
      // Each half of the line is nearest to one corner.
      const int nearest = (line % lines_an_axis < lines_an_axis / 2 ? 0 : 1) +
                          (line / lines_an_axis < lines_an_axis / 2 ? 0 : 2);
      const double middle = 0.5 * (lines.from[i] + lines.to[i]);
      if ((scanned >> nearest) & 1) sum += 0.5 * length_within(lines.from[i], middle, low_, high_);
      if ((scanned >> (nearest + 4)) & 1) sum += 0.5 * length_within(middle, lines.to[i], low_, high_);
    }
    return sum / line_count;
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
