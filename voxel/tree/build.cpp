// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/build.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <span>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "voxel/space/error.h"
#include "voxel/tree/octree_node.h"
#include "voxel/tree/window_bits.h"

namespace octotomy::voxel {
namespace {

// A dense grid of blocks of one height, x fastest.
struct BlockGrid {
  explicit BlockGrid(const glm::ivec3& blocks_each_way)
      : dims(blocks_each_way),
        blocks(static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
               static_cast<std::size_t>(dims.z)) {}

  glm::ivec3 dims;
  std::vector<BlockRef> blocks;

  std::size_t index(const glm::ivec3& block) const {
    return static_cast<std::size_t>(block.x) +
           static_cast<std::size_t>(dims.x) *
               (static_cast<std::size_t>(block.y) +
                static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(block.z));
  }
};

// Fills the grid's rows along x in parallel; `fill` gets the position of a row's first block.
using FillRow = std::function<void(const glm::ivec3& first, std::span<BlockRef> row)>;
void fill_rows(BlockGrid& grid, const FillRow& fill) {
  tbb::parallel_for(0, grid.dims.y * grid.dims.z, [&](int row) {
    const glm::ivec3 first{0, row % grid.dims.y, row / grid.dims.y};
    fill(first, std::span(grid.blocks).subspan(grid.index(first), static_cast<std::size_t>(grid.dims.x)));
  });
}

// Makes a FillRow from `make`, which returns a single block.
template <typename Make>
FillRow block_by_block(const Make& make) {
  return [&make](const glm::ivec3& first, std::span<BlockRef> row) {
    for (std::size_t x = 0; x < row.size(); ++x)
      row[x] = make(first + glm::ivec3(static_cast<int>(x), 0, 0)).detach();
  };
}

// Joins blocks of height h, 4 x 4 x 4 at a time, to blocks of height h + 1.
BlockGrid parents(const BlockGrid& children, int parent_height) {
  BlockGrid grid((children.dims + 3) / 4);
  const auto join = [&](const glm::ivec3& parent) {
    std::array<BlockRef, 64> present;
    std::size_t count = 0;
    std::uint64_t full = 0;
    std::uint64_t undecided = 0;
    for (int child = 0; child < 64; ++child) {
      const glm::ivec3 at = parent * 4 + child_place(child);
      if (glm::any(glm::greaterThanEqual(at, children.dims))) continue;
      const BlockRef block = children.blocks[children.index(at)];
      if (block.is_full()) full |= std::uint64_t{1} << child;
      if (block.node() == nullptr) continue;
      undecided |= std::uint64_t{1} << child;
      present[count++] = block;
    }
    return make_block(parent_height, full, undecided, {present.data(), count});
  };
  fill_rows(grid, block_by_block(join));
  return grid;
}

// Builds an octree from a grid of `dims` blocks of height 2 that begins at the universe's first voxel. Blocks
// beyond the grid are empty.
Octree octree_of_grid(const Universe& universe, const glm::ivec3& dims, const FillRow& fill) {
  BlockGrid grid(dims);
  fill_rows(grid, fill);
  for (int height = 3; height <= root_height(universe.depth); ++height) grid = parents(grid, height);
  return {universe, Block::adopt(grid.blocks.front())};
}

// The voxels of the box low..high within a block of `height` at `origin`, as a block.
Block block_of_box(int height, const glm::ivec3& origin, const glm::ivec3& low, const glm::ivec3& high) {
  const glm::ivec3 last = origin + (1 << (2 * height)) - 1;
  if (glm::any(glm::greaterThan(low, last)) || glm::any(glm::lessThan(high, origin))) return {};
  if (glm::all(glm::lessThanEqual(low, origin)) && glm::all(glm::greaterThanEqual(high, last)))
    return Block::adopt(BlockRef::full());
  if (height > 2) {
    std::array<BlockRef, 64> children;
    for (int child = 0; child < 64; ++child)
      children[static_cast<std::size_t>(child)] =
          block_of_box(height - 1, origin + (child_place(child) << (2 * height - 2)), low, high).detach();
    return make_block(height, 0, all_children, children);
  }
  const glm::ivec3 from = glm::max(low - origin, 0);
  const glm::ivec3 to = glm::min(high - origin, 15);
  BlockRows rows{};
  for (int z = from.z; z <= to.z; ++z)
    for (int y = from.y; y <= to.y; ++y)
      rows[static_cast<std::size_t>(y + 16 * z)] =
          static_cast<std::uint16_t>((0xffff >> (15 - to.x)) & (0xffff << from.x));
  return leaf_block_of_rows(rows);
}

void check_fits(const Universe& universe, const Scene& scene) {
  check(scene);
  if (scene.lattice.lps_from_voxel != universe.lps_from_voxel)
    throw InvalidInput(scene.source + ": the scan's voxels are not the universe's: resample the scan first");
  if (glm::any(glm::greaterThan(scene.lattice.dims, glm::ivec3(universe.side()))))
    throw InvalidInput(scene.source + ": the scan is larger than the universe of " +
                       std::to_string(universe.side()) + " voxels a side");
}

}  // namespace

Block leaf_block_of_rows(const BlockRows& rows) {
  if (std::accumulate(rows.begin(), rows.end(), std::uint16_t{0}, std::bit_or<>()) == 0) return {};
  std::array<std::uint64_t, 64> words{};
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 16; ++y) {
      const std::uint64_t bits = rows[static_cast<std::size_t>(y + 16 * z)];
      if (bits == 0) continue;
      const int shift = child_index(0, y & 3, z & 3);
      std::uint64_t* leaf = &words[static_cast<std::size_t>(child_index(0, y >> 2, z >> 2))];
      for (int x = 0; x < 4; ++x) leaf[x] |= ((bits >> (4 * x)) & 15) << shift;
    }
  return make_leaf_block(0, all_children, words.data());
}

Octree octree_of_box(const Universe& universe, const glm::ivec3& low, const glm::ivec3& high) {
  return {universe, block_of_box(root_height(universe.depth), glm::ivec3(0), glm::max(low, 0),
                                 glm::min(high, universe.side() - 1))};
}

Octree octree_of_blocks(const Universe& universe, const std::function<Block(const glm::ivec3& block)>& make) {
  return octree_of_grid(universe, glm::ivec3((universe.side() + 15) / 16), block_by_block(make));
}

Octree octree_of_window(const Universe& universe, const Scene& scene, double low, double high) {
  check_fits(universe, scene);
  low = above_padding(scene, low);
  const glm::ivec3 dims = scene.lattice.dims;
  const auto row_start = [&](int y, int z) {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(dims.y) + static_cast<std::size_t>(y)) *
           static_cast<std::size_t>(dims.x);
  };
  // Samples are read in whole rows, in memory order.
  const auto build = [&](const auto& row_bits) {
    return octree_of_grid(universe, (dims + 15) / 16, [&](const glm::ivec3& first, std::span<BlockRef> row) {
      const glm::ivec3 origin = first * 16;
      const glm::ivec3 count = glm::min(glm::ivec3(16), dims - origin);
      std::vector<BlockRows> rows(row.size());
      for (int z = 0; z < count.z; ++z)
        for (int y = 0; y < count.y; ++y) {
          const std::size_t start = row_start(origin.y + y, origin.z + z);
          for (std::size_t x = 0; x < row.size(); ++x)
            rows[x][static_cast<std::size_t>(y + 16 * z)] = static_cast<std::uint16_t>(
                row_bits(start + 16 * x, std::min(16, dims.x - 16 * static_cast<int>(x))));
        }
      for (std::size_t x = 0; x < row.size(); ++x) row[x] = leaf_block_of_rows(rows[x]).detach();
    });
  };
  if (const auto* shorts = std::get_if<Int16Samples>(&scene.samples)) {
    const std::optional<Window16> window = window16(low, high);
    if (!window) return Octree::empty(universe);
    return build([&](std::size_t start, int width) -> std::uint64_t {
      if (width == 16) return window_bits16(shorts->data() + start, *window);
      std::uint64_t bits = 0;
      for (int x = 0; x < width; ++x) {
        const std::int16_t value = (*shorts)[start + static_cast<std::size_t>(x)];
        bits |= std::uint64_t{value >= window->low && value <= window->high} << x;
      }
      return bits;
    });
  }
  const auto& floats = std::get<FloatSamples>(scene.samples);
  return build([&](std::size_t start, int width) {
    std::uint64_t bits = 0;
    for (int x = 0; x < width; ++x) {
      const double value = floats[start + static_cast<std::size_t>(x)];
      bits |= std::uint64_t{value >= low && value <= high} << x;
    }
    return bits;
  });
}

}  // namespace octotomy::voxel
