// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/grey_octree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <vector>

#include "voxel/tree/build.h"
#include "voxel/tree/octree_node.h"

// Passes: 1 find the blocks that the scan reaches and number their bricks; 2 fill the bricks, each with the
// ranges of its leaves and the block of its voxels that lie in the scan; 3 join ranges level by level up to
// the root, and the blocks to the scan's octree.

namespace octotomy::voxel {
namespace {

std::int16_t rounded(double value, const Scene& scene) {
  const double nearest = std::floor(value + 0.5);
  if (!(nearest >= std::numeric_limits<std::int16_t>::min() &&
        nearest <= std::numeric_limits<std::int16_t>::max()))
    throw std::invalid_argument(scene.source + ": the sample " + std::to_string(value) +
                                " does not fit into 16 bits: rescale the scan first");
  return static_cast<std::int16_t>(nearest);
}

constexpr int row_length = 16;
using Row = std::array<std::int16_t, row_length>;

// Reads the scan along the universe's rows, 16 voxels at a time.
template <typename Sample>
class Resampler {
 public:
  Resampler(const Universe& universe, const Scene& scene, const Sample* samples, std::int16_t background)
      : scene_(scene),
        samples_(samples),
        dims_(scene.lattice.dims),
        background_(background),
        scan_from_universe_(glm::inverse(scene.lattice.lps_from_voxel) * universe.lps_from_voxel),
        offset_(whole_voxel_offset(scan_from_universe_)) {
    if (!offset_ && is_diagonal()) {
      for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < std::max(universe.side(), row_length); ++i) {
          glm::dvec3 voxel(0.0);
          voxel[axis] = i;
          along_[static_cast<std::size_t>(axis)].push_back(place(axis, position(voxel)[axis]));
        }
    }
  }

  // Fills the row; bit i of the answer is set if its voxel i lies in the scan.
  std::uint16_t read(const glm::ivec3& first, Row& row) const {
    if (offset_) return copy(first + *offset_, row);
    unsigned inside = 0;
    for (int i = 0; i < row_length; ++i) {
      const auto [x, y, z] = places(first + glm::ivec3(i, 0, 0));
      const bool in = x.inside && y.inside && z.inside;
      row[static_cast<std::size_t>(i)] = in ? value(x, y, z) : background_;
      inside |= static_cast<unsigned>(in) << i;
    }
    return static_cast<std::uint16_t>(inside);
  }

 private:
  // The place of a position along one axis: between two samples, or outside.
  struct Place {
    int low = 0;
    int high = 0;
    double share = 0.0;  ///< of the higher one
    bool inside = false;
  };

  glm::dvec3 position(const glm::dvec3& voxel) const {
    return glm::dvec3(scan_from_universe_ * glm::dvec4(voxel, 1.0));
  }
  bool is_diagonal() const {
    for (int column = 0; column < 3; ++column)
      for (int row = 0; row < 3; ++row)
        if (column != row && scan_from_universe_[column][row] != 0.0) return false;
    return true;
  }
  Place place(int axis, double p) const {
    Place result;
    result.inside = p >= -0.5 && p <= dims_[axis] - 0.5;
    if (!result.inside) return result;
    const double clamped = std::clamp(p, 0.0, dims_[axis] - 1.0);
    result.low = static_cast<int>(clamped);
    result.high = std::min(result.low + 1, dims_[axis] - 1);
    result.share = clamped - result.low;
    return result;
  }

  std::array<Place, 3> places(const glm::ivec3& voxel) const {
    const auto known = [&](int axis) {
      return along_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(voxel[axis])];
    };
    if (!along_[0].empty()) return {known(0), known(1), known(2)};
    const glm::dvec3 p = position(glm::dvec3(voxel));
    return {place(0, p.x), place(1, p.y), place(2, p.z)};
  }

  std::uint16_t copy(const glm::ivec3& first, Row& row) const {
    row.fill(background_);
    if (first.y < 0 || first.z < 0 || first.y >= dims_.y || first.z >= dims_.z) return 0;
    const Sample* source = sample_row(first.y, first.z) + first.x;
    const int begin = std::max(0, -first.x);
    const int end = std::min(row_length, dims_.x - first.x);
    if (begin >= end) return 0;
    for (int i = begin; i < end; ++i) {
      if constexpr (std::is_same_v<Sample, std::int16_t>)
        row[static_cast<std::size_t>(i)] = source[i];
      else
        row[static_cast<std::size_t>(i)] = rounded(source[i], scene_);
    }
    return static_cast<std::uint16_t>((0xffff >> (row_length - end)) & (0xffff << begin));
  }

  const Sample* sample_row(int y, int z) const {
    const auto row =
        static_cast<std::size_t>(z) * static_cast<std::size_t>(dims_.y) + static_cast<std::size_t>(y);
    return samples_ + row * static_cast<std::size_t>(dims_.x);
  }
  std::int16_t value(const Place& x, const Place& y, const Place& z) const {
    const auto along_x = [&](int j, int k) {
      const Sample* row = sample_row(j, k);
      return static_cast<double>(row[x.low]) * (1.0 - x.share) + static_cast<double>(row[x.high]) * x.share;
    };
    const double below = along_x(y.low, z.low) * (1.0 - y.share) + along_x(y.high, z.low) * y.share;
    const double above = along_x(y.low, z.high) * (1.0 - y.share) + along_x(y.high, z.high) * y.share;
    return rounded(below * (1.0 - z.share) + above * z.share, scene_);
  }

  const Scene& scene_;
  const Sample* samples_;
  glm::ivec3 dims_;
  std::int16_t background_;
  glm::dmat4 scan_from_universe_;
  std::optional<glm::ivec3> offset_;         ///< of the scan's samples, if the two lattices coincide
  std::array<std::vector<Place>, 3> along_;  ///< per axis and voxel, if the lattices' axes are parallel
};

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

MinMax range_of(const GreyBrick& brick) {
  MinMax range = brick.leaf_range.front();
  for (const MinMax& leaf : brick.leaf_range) range.widen(leaf);
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
  for (auto& leaf : storage.bricks.front().samples) leaf.fill(background);
  storage.bricks.front().leaf_range.fill({background, background});
}

// Fills a brick and gives the block of its voxels that lie in the scan.
template <typename Sample>
Block fill(GreyBrick& brick, const glm::ivec3& origin, int side, const Resampler<Sample>& resampler,
           std::int16_t background) {
  Row row;
  BlockRows scan{};
  const auto within = static_cast<std::uint16_t>(0xffff >> std::max(0, 16 - side));
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 16; ++y) {
      // Only universes of less than 16 voxels a side have rows beyond them.
      if (origin.y + y >= side || origin.z + z >= side)
        row.fill(background);
      else
        scan[static_cast<std::size_t>(y + 16 * z)] =
            resampler.read(origin + glm::ivec3(0, y, z), row) & within;
      for (int leaf = 0; leaf < 4; ++leaf)
        std::copy_n(row.begin() + 4 * leaf, 4,
                    brick.samples[static_cast<std::size_t>(child_index(leaf, y >> 2, z >> 2))].begin() +
                        child_index(0, y & 3, z & 3));
    }
  set_leaf_ranges(brick);
  const bool whole = std::all_of(scan.begin(), scan.end(), [](std::uint16_t bits) { return bits == 0xffff; });
  return whole ? Block::adopt(BlockRef::full()) : leaf_block_of_rows(scan);
}

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
      storage_->bricks.size() * sizeof(GreyBrick) + storage_->brick_of_block.size() * sizeof(std::uint32_t);
  for (const Level& level : storage_->levels) bytes += level.ranges.size() * sizeof(MinMax);
  return bytes + octotomy::voxel::bytes_memory(scan());
}

GreyOctree grey_octree_of(const Universe& universe, const Scene& scene, std::int16_t background) {
  check(scene);
  // 1. Number the bricks: 0 is background, then the blocks within reach, x fastest.
  const auto [first_voxel, last_voxel] = reach(universe, scene.lattice);
  const glm::ivec3 first = first_voxel >> 4;
  const glm::ivec3 count = (last_voxel >> 4) - first + 1;
  auto storage = std::make_shared<GreyOctree::Storage>();
  GreyOctree::Level bottom;
  clear(*storage, bottom, universe, background,
        static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y) *
            static_cast<std::size_t>(count.z));
  std::uint32_t next = 1;
  for (int z = 0; z < count.z; ++z)
    for (int y = 0; y < count.y; ++y)
      for (int x = 0; x < count.x; ++x)
        storage->brick_of_block[bottom.index(first + glm::ivec3(x, y, z))] = next++;

  // 2. Fill them.
  std::vector<Block> scan(storage->bricks.size());
  std::visit(
      [&](const auto& samples) {
        const Resampler resampler(universe, scene, samples.data(), background);
        tbb::parallel_for(0, count.y * count.z, [&](int row) {
          for (int x = 0; x < count.x; ++x) {
            const glm::ivec3 block = first + glm::ivec3(x, row % count.y, row / count.y);
            const std::uint32_t number = storage->brick_of_block[bottom.index(block)];
            GreyBrick& brick = storage->bricks[number];
            scan[number] = fill(brick, block * 16, universe.side(), resampler, background);
            bottom.ranges[bottom.index(block)] = range_of(brick);
          }
        });
      },
      scene.samples);

  // 3. Join the ranges and the scan's blocks.
  storage->scan = octree_of_blocks(universe, [&](const glm::ivec3& block) {
    const std::uint32_t number = storage->brick_of_block[bottom.index(block)];
    return number == 0 ? Block() : std::move(scan[number]);
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
    bottom.ranges[bottom.index(blocks[i])] = range_of(brick);
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
