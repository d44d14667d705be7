// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/grey_octree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <unordered_map>
#include <vector>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "voxel/space/vector_clones.h"
#include "voxel/tree/build.h"
#include "voxel/tree/octree_node.h"
#include "voxel/tree/scan_rows.h"

// Passes: 1 find the blocks that the scan reaches; 2 fill their bricks, each with the ranges of its leaves
// and the block of its voxels that lie in the scan, a layer of blocks of the same z at a time; 3 join ranges
// level by level up to the root, and the blocks to the scan's octree.
//
// Memory is what building costs: new pages take longer than what is written to them. So a brick of one value
// is shared, and the others of a layer follow each other. Samples that stay unchanged are copied straight
// into bricks: of each run of blocks first the ranges are found, row by row; then, while the run is in the
// cache, its samples are stored past it.

namespace octotomy::voxel {
namespace {

// First and last universe voxel, clamped to the universe, that a scan can reach.
std::pair<glm::ivec3, glm::ivec3> reach(const Universe& universe, const Lattice& lattice) {
  const glm::dmat4 universe_from_scan = glm::inverse(universe.lps_from_voxel) * lattice.lps_from_voxel;
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 p(universe_from_scan * glm::dvec4(side * glm::dvec3(lattice.dims) - 0.5, 1.0));
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 last(universe.side() - 1);
  return {glm::ivec3(glm::clamp(glm::floor(low), glm::dvec3(0.0), last)),
          glm::ivec3(glm::clamp(glm::ceil(high), glm::dvec3(0.0), last))};
}

void set_leaf_ranges(GreyBrick& brick) {
  for (std::size_t leaf = 0; leaf < 64; ++leaf) {
    MinMax range{brick.samples[leaf][0], brick.samples[leaf][0]};
    for (const std::int16_t sample : brick.samples[leaf]) range.widen({sample, sample});
    brick.leaf_range[leaf] = range;
  }
}

MinMax joined(const std::array<MinMax, 64>& leaves) {
  MinMax range = leaves.front();
  for (const MinMax& leaf : leaves) range.widen(leaf);
  return range;
}

// Adds the levels above the bottom one, up to the root's.
template <typename Level>
void join_ranges(std::vector<Level>& levels, int depth) {
  for (int height = 3; height <= root_height(depth); ++height) {
    const Level& below = levels.back();
    Level level;
    level.side = (below.side + 3) / 4;
    level.ranges.resize(static_cast<std::size_t>(level.side) * static_cast<std::size_t>(level.side) *
                        static_cast<std::size_t>(level.side));
    for (int z = 0; z < level.side; ++z)
      for (int y = 0; y < level.side; ++y)
        for (int x = 0; x < level.side; ++x) {
          const glm::ivec3 parent(x, y, z);
          MinMax range = below.ranges[below.index(parent * 4)];
          for (int child = 1; child < 64; ++child) {
            const glm::ivec3 at = parent * 4 + child_place(child);
            if (glm::all(glm::lessThan(at, glm::ivec3(below.side))))
              range.widen(below.ranges[below.index(at)]);
          }
          level.ranges[level.index(parent)] = range;
        }
    levels.push_back(std::move(level));
  }
}

// Bottom level and bricks of a grey octree that is all background: brick 0.
template <typename Storage, typename Level>
void clear(Storage& storage, Level& bottom, const Universe& universe, std::int16_t background,
           std::size_t brick_count) {
  storage.universe = universe;
  storage.background = background;
  bottom.side = (universe.side() + 15) / 16;
  const auto side = static_cast<std::size_t>(bottom.side);
  bottom.ranges.assign(side * side * side, {background, background});
  storage.brick_of_block.assign(side * side * side, 0);
  storage.bricks.resize(brick_count + 1);
  storage.brick_count = brick_count + 1;
  for (auto& leaf : storage.bricks.front().samples) leaf.fill(background);
  storage.bricks.front().leaf_range.fill({background, background});
}

using LeafRanges = std::array<MinMax, 64>;

// Blocks along x that are taken over at once: their 256 rows of 512 samples stay in a cache of 256 KiB until
// they are copied.
constexpr std::size_t longest_run = 32;

// Widens ranges by column by a row of samples.
OCTOTOMY_VECTOR_CLONES void widen(const std::int16_t* samples, std::size_t width, std::int16_t* low,
                                  std::int16_t* high) {
  for (std::size_t x = 0; x < width; ++x) {
    const std::int16_t sample = samples[x];
    low[x] = sample < low[x] ? sample : low[x];
    high[x] = sample > high[x] ? sample : high[x];
  }
}

// The ranges of the leaves of a run of blocks along x, from the samples of the first one. Rows are read in
// the order in which they lie in memory.
void find_ranges(const std::int16_t* first, const RowSteps& steps, std::size_t count, LeafRanges* ranges) {
  const std::size_t width = 16 * count;
  for (std::size_t z = 0; z < 16; z += 4) {
    // By column; then four columns to a leaf.
    std::array<std::array<std::int16_t, 16 * longest_run>, 4> low, high;
    for (std::size_t slice = z; slice < z + 4; ++slice)
      for (std::size_t y = 0; y < 16; ++y) {
        const std::int16_t* const samples = first + y * steps.row + slice * steps.slice;
        if (slice == z && y % 4 == 0) {
          std::copy_n(samples, width, low[y / 4].begin());
          std::copy_n(samples, width, high[y / 4].begin());
        } else {
          widen(samples, width, low[y / 4].data(), high[y / 4].data());
        }
      }
    for (std::size_t y = 0; y < 4; ++y)
      for (std::size_t leaf = 0; leaf < 4 * count; ++leaf) {
        MinMax range{low[y][4 * leaf], high[y][4 * leaf]};
        for (std::size_t x = 1; x < 4; ++x) range.widen({low[y][4 * leaf + x], high[y][4 * leaf + x]});
        ranges[leaf / 4][leaf % 4 + 4 * (y + z)] = range;
      }
  }
}

// Copies a block's samples into their order by leaves.
void copy_block(const std::int16_t* first, const RowSteps& steps, GreyBrick& brick) {
  for (std::size_t line = 0; line < 16; ++line)
    for (std::size_t row = 0; row < 16; row += 2) {
      const std::int16_t* const a =
          first + (4 * (line % 4) + row % 4) * steps.row + (4 * (line / 4) + row / 4) * steps.slice;
      const std::int16_t* const b = a + steps.row;
#if defined(__SSE2__)
      for (std::size_t half = 0; half < 2; ++half) {
        const __m128i of_a = _mm_loadu_si128(reinterpret_cast<const __m128i*>(a + 8 * half));
        const __m128i of_b = _mm_loadu_si128(reinterpret_cast<const __m128i*>(b + 8 * half));
        auto* const to = &brick.samples[4 * line + 2 * half];
        _mm_stream_si128(reinterpret_cast<__m128i*>(&to[0][4 * row]), _mm_unpacklo_epi64(of_a, of_b));
        _mm_stream_si128(reinterpret_cast<__m128i*>(&to[1][4 * row]), _mm_unpackhi_epi64(of_a, of_b));
      }
#else
      for (std::size_t leaf = 0; leaf < 4; ++leaf) {
        std::copy_n(a + 4 * leaf, 4, &brick.samples[4 * line + leaf][4 * row]);
        std::copy_n(b + 4 * leaf, 4, &brick.samples[4 * line + leaf][4 * row + 4]);
      }
#endif
    }
}

// The blocks that the scan reaches.
struct Reached {
  glm::ivec3 first{0}, count{0};
  int per_layer() const { return count.x * count.y; }
  int number(const glm::ivec3& at) const { return at.x + count.x * (at.y + count.y * at.z); }
};

// A layer of blocks of the same z. Its bricks follow each other from a place of its own on.
template <typename Storage, typename Level>
class LayerFill {
 public:
  LayerFill(const ScanRows& rows, const Reached& reached, int z, Storage& storage, Level& bottom)
      : scan_rows_(rows),
        reached_(reached),
        z_(z),
        storage_(storage),
        bottom_(bottom),
        next_(1 + static_cast<std::uint32_t>(reached.number({0, 0, z}))),
        shared_{{storage.background, 0}} {}

  // `scan` takes the blocks of voxels that lie in the scan. Returns how many bricks there are.
  std::size_t run(std::vector<Block>& scan) {
    const std::uint32_t first = next_;
    for (int y = 0; y < reached_.count.y; ++y)
      for (int x = 0; x < reached_.count.x;) {
        const glm::ivec3 at(x, y, z_);
        const std::int16_t* const own = scan_samples(at);
        const auto is_alike = [&](int i) {
          return (scan_samples(at + glm::ivec3(i, 0, 0)) != nullptr) == (own != nullptr);
        };
        int count = 1;
        while (count < static_cast<int>(longest_run) && x + count < reached_.count.x && is_alike(count))
          ++count;
        if (own != nullptr) {
          for (int i = 0; i < count; ++i) scan[number(at, i)] = Block::adopt(BlockRef::full());
          place(at, count, own, scan_rows_.steps());
        } else {
          resample(at, count, scan);
          place(at, count, rows_.data(), {16 * longest_run, 256 * longest_run});
        }
        x += count;
      }
#if defined(__SSE2__)
    _mm_sfence();  // before other threads read what was stored past the cache
#endif
    return next_ - first;
  }

 private:
  glm::ivec3 origin(const glm::ivec3& at) const {
    return 16 * (reached_.first + at);
  }
  std::size_t number(const glm::ivec3& at, int i) const {
    return static_cast<std::size_t>(reached_.number(at + glm::ivec3(i, 0, 0)));
  }

  // The scan's sample of a block's first voxel, if all of the block's samples are the scan's own; else null.
  const std::int16_t* scan_samples(const glm::ivec3& at) const {
    // Blocks of a smaller universe reach beyond it.
    return storage_.universe.side() < 16 ? nullptr : scan_rows_.own_samples(origin(at));
  }

  // Fills rows_ with `count` blocks along x from `at` on.
  void resample(const glm::ivec3& at, int count, std::vector<Block>& scan) {
    rows_.resize(256 * 16 * longest_run);
    std::array<BlockRows, longest_run> inside{};
    const glm::ivec3 first = origin(at);
    const int side = storage_.universe.side();
    const auto within = static_cast<std::uint16_t>(0xffff >> std::max(0, 16 - side));
    std::int16_t* row = rows_.data();
    for (int z = 0; z < 16; ++z)
      for (int y = 0; y < 16; ++y, row += 16 * longest_run) {
        // Only universes of less than 16 voxels a side end within a block.
        if (first.y + y >= side || first.z + z >= side) {
          std::fill_n(row, 16 * count, storage_.background);
          continue;
        }
        for (int i = 0; i < count; ++i)
          inside[static_cast<std::size_t>(i)][static_cast<std::size_t>(y + 16 * z)] =
              scan_rows_.read(first + glm::ivec3(16 * i, y, z), row + 16 * i) & within;
        if (side < 16) std::fill(row + side, row + 16, storage_.background);
      }
    for (int i = 0; i < count; ++i) {
      const BlockRows& bits = inside[static_cast<std::size_t>(i)];
      const bool whole = std::all_of(bits.begin(), bits.end(), [](std::uint16_t b) { return b == 0xffff; });
      scan[number(at, i)] = whole ? Block::adopt(BlockRef::full()) : leaf_block_of_rows(bits);
    }
  }

  // Gives `count` blocks along x their bricks, from the samples of the first one.
  void place(const glm::ivec3& at, int count, const std::int16_t* samples, const RowSteps& steps) {
    std::array<LeafRanges, longest_run> ranges;
    find_ranges(samples, steps, static_cast<std::size_t>(count), ranges.data());
    for (int i = 0; i < count; ++i)
      if (GreyBrick* const brick = placed(at + glm::ivec3(i, 0, 0), ranges[static_cast<std::size_t>(i)]))
        copy_block(samples + 16 * i, steps, *brick);
  }

  // Gives a block its brick. Returns it with its ranges, if its samples are still to be written.
  GreyBrick* placed(const glm::ivec3& at, const LeafRanges& ranges) {
    const std::size_t index = bottom_.index(reached_.first + at);
    const MinMax range = bottom_.ranges[index] = joined(ranges);
    std::uint32_t& number = storage_.brick_of_block[index];
    if (range.low == range.high) {
      const auto [known, is_new] = shared_.try_emplace(range.low, next_);
      number = known->second;
      if (!is_new) return nullptr;
    }
    number = next_++;
    GreyBrick& brick = storage_.bricks[number];
    brick.leaf_range = ranges;
    return &brick;
  }

  const ScanRows& scan_rows_;
  const Reached& reached_;
  int z_;
  Storage& storage_;
  Level& bottom_;
  std::uint32_t next_;                                      // brick
  std::unordered_map<std::int16_t, std::uint32_t> shared_;  // bricks of one value
  std::vector<std::int16_t> rows_;                          // of a run that is resampled, z after y
};

}  // namespace

std::int16_t GreyOctree::sample(const glm::ivec3& voxel) const {
  if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) ||
      glm::any(glm::greaterThanEqual(voxel, glm::ivec3(universe().side()))))
    return background();
  const glm::ivec3 leaf = (voxel >> 2) & 3;
  const glm::ivec3 bit = voxel & 3;
  return brick(voxel >> 4)
      .samples[static_cast<std::size_t>(child_index(leaf.x, leaf.y, leaf.z))]
              [static_cast<std::size_t>(child_index(bit.x, bit.y, bit.z))];
}

std::uint64_t GreyOctree::bytes_memory() const {
  std::uint64_t bytes =
      storage_->brick_count * sizeof(GreyBrick) + storage_->brick_of_block.size() * sizeof(std::uint32_t);
  for (const Level& level : storage_->levels) bytes += level.ranges.size() * sizeof(MinMax);
  return bytes + octotomy::voxel::bytes_memory(scan());
}

GreyOctree grey_octree_of(const Universe& universe, const Scene& scene, std::int16_t background) {
  check(scene);
  // 1. Find the blocks.
  const auto [first_voxel, last_voxel] = reach(universe, scene.lattice);
  const Reached reached{first_voxel >> 4, (last_voxel >> 4) - (first_voxel >> 4) + 1};
  const auto block_count =
      static_cast<std::size_t>(reached.per_layer()) * static_cast<std::size_t>(reached.count.z);
  auto storage = std::make_shared<GreyOctree::Storage>();
  GreyOctree::Level bottom;
  clear(*storage, bottom, universe, background, block_count);

  // 2. Fill their bricks.
  std::vector<Block> scan(block_count);
  std::vector<std::size_t> brick_counts(static_cast<std::size_t>(reached.count.z));
  const ScanRows rows(universe, scene, background);
  tbb::parallel_for(0, reached.count.z, [&](int z) {
    brick_counts[static_cast<std::size_t>(z)] = LayerFill(rows, reached, z, *storage, bottom).run(scan);
  });
  storage->brick_count = std::accumulate(brick_counts.begin(), brick_counts.end(), std::size_t{1});

  // 3. Join the ranges and the scan's blocks.
  storage->scan = octree_of_blocks(universe, [&](const glm::ivec3& block) {
    const glm::ivec3 at = block - reached.first;
    const bool is_reached =
        glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, reached.count));
    return is_reached ? std::move(scan[static_cast<std::size_t>(reached.number(at))]) : Block();
  });
  storage->levels.push_back(std::move(bottom));
  join_ranges(storage->levels, universe.depth);
  return GreyOctree(std::move(storage));
}

GreyOctree grey_octree_of_bricks(const Universe& universe, std::int16_t background,
                                 std::span<const glm::ivec3> blocks,
                                 const std::function<void(std::size_t number, GreyBrick& brick)>& fill,
                                 std::optional<Octree> scan) {
  if (scan && !(scan->universe() == universe))
    throw std::invalid_argument("the scan's voxels are of another universe than its bricks");
  auto storage = std::make_shared<GreyOctree::Storage>();
  GreyOctree::Level bottom;
  clear(*storage, bottom, universe, background, blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const glm::ivec3& block = blocks[i];
    if (glm::any(glm::lessThan(block, glm::ivec3(0))) ||
        glm::any(glm::greaterThanEqual(block, glm::ivec3(bottom.side))))
      throw std::invalid_argument("a brick lies outside the universe");
    std::uint32_t& brick = storage->brick_of_block[bottom.index(block)];
    if (brick != 0) throw std::invalid_argument("two bricks have the same place");
    brick = static_cast<std::uint32_t>(i + 1);
  }
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
    GreyBrick& brick = storage->bricks[i + 1];
    fill(i, brick);
    set_leaf_ranges(brick);
    bottom.ranges[bottom.index(blocks[i])] = joined(brick.leaf_range);
  });
  storage->levels.push_back(std::move(bottom));
  join_ranges(storage->levels, universe.depth);
  const GreyOctree grey(storage);
  storage->scan = scan ? std::move(*scan) : scan_box(grey);
  return grey;
}

namespace {

// Widens a box by the samples of a block of height `height`, or 1 for a leaf, that are not the background.
class BoxOfSamples {
 public:
  explicit BoxOfSamples(const GreyOctree& grey) : grey_(grey) {}

  void add(int height, const glm::ivec3& block) {
    const glm::ivec3 origin = block << (2 * height);
    const glm::ivec3 last = glm::min(origin + (1 << (2 * height)), grey_.universe().side()) - 1;
    if (glm::any(glm::greaterThan(origin, last))) return;
    if (glm::all(glm::lessThanEqual(low, origin)) && glm::all(glm::greaterThanEqual(high, last))) return;
    const MinMax range = range_of(height, block);
    const std::int16_t background = grey_.background();
    if (range.low == background && range.high == background) return;
    if (range.low > background || range.high < background) {
      low = glm::min(low, origin);
      high = glm::max(high, last);
    } else if (height == 0) {
      low = glm::min(low, block);
      high = glm::max(high, block);
    } else {
      for (int child = 0; child < 64; ++child) add(height - 1, 4 * block + child_place(child));
    }
  }

  glm::ivec3 low{std::numeric_limits<int>::max()};
  glm::ivec3 high{-1};

 private:
  MinMax range_of(int height, const glm::ivec3& block) const {
    if (height >= 2) return grey_.range(height, block);
    const glm::ivec3 leaf = height == 1 ? block & 3 : (block >> 2) & 3;
    const auto number = static_cast<std::size_t>(child_index(leaf.x, leaf.y, leaf.z));
    if (height == 1) return grey_.brick(block >> 2).leaf_range[number];
    const std::int16_t sample = grey_.sample(block);
    return {sample, sample};
  }

  const GreyOctree& grey_;
};

}  // namespace

Octree scan_box(const GreyOctree& grey) {
  BoxOfSamples box(grey);
  box.add(root_height(grey.universe().depth), glm::ivec3(0));
  return octree_of_box(grey.universe(), box.low, box.high);
}

}  // namespace octotomy::voxel
