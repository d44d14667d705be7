// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/grey_octree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "voxel/octree_node.h"

// Passes: 1 find the blocks that the scan reaches and number their bricks; 2 fill the bricks, each with the
// ranges of its leaves; 3 join ranges level by level up to the root.

namespace octotomy::voxel {
namespace {

void widen(MinMax& range, const MinMax& by) {
  range.low = std::min(range.low, by.low);
  range.high = std::max(range.high, by.high);
}

// Reads the scene along the universe's rows. Samples are asked for voxel by voxel in ascending x.
template <typename Sample>
class Resampler {
 public:
  Resampler(const Universe& universe, const Lattice& lattice, const Sample* samples)
      : samples_(samples),
        dims_(lattice.dims),
        scan_from_universe_(glm::inverse(lattice.lps_from_voxel) * universe.lps_from_voxel),
        coincident_(lattice.lps_from_voxel == universe.lps_from_voxel) {}

  // The value at a universe voxel, or `background` where its centre is outside the scan.
  double value(const glm::ivec3& voxel, double background) const {
    if (coincident_) return inside(voxel) ? static_cast<double>(at(voxel)) : background;
    const glm::dvec3 p = glm::dvec3(scan_from_universe_ * glm::dvec4(glm::dvec3(voxel), 1.0));
    for (int axis = 0; axis < 3; ++axis)
      if (!(p[axis] >= -0.5 && p[axis] <= dims_[axis] - 0.5)) return background;
    return interpolate(p);
  }

 private:
  bool inside(const glm::ivec3& voxel) const {
    return voxel.x >= 0 && voxel.y >= 0 && voxel.z >= 0 && voxel.x < dims_.x && voxel.y < dims_.y &&
           voxel.z < dims_.z;
  }
  Sample at(const glm::ivec3& i) const {
    const auto row =
        static_cast<std::size_t>(i.z) * static_cast<std::size_t>(dims_.y) + static_cast<std::size_t>(i.y);
    return samples_[row * static_cast<std::size_t>(dims_.x) + static_cast<std::size_t>(i.x)];
  }
  double interpolate(const glm::dvec3& position) const {
    const glm::dvec3 p = glm::clamp(position, glm::dvec3(0.0), glm::dvec3(dims_ - 1));
    const glm::ivec3 low(p);
    const glm::ivec3 high = glm::min(low + 1, dims_ - 1);
    const glm::dvec3 t = p - glm::dvec3(low);
    const auto along_x = [&](int y, int z) {
      return static_cast<double>(at({low.x, y, z})) * (1.0 - t.x) +
             static_cast<double>(at({high.x, y, z})) * t.x;
    };
    const double below = along_x(low.y, low.z) * (1.0 - t.y) + along_x(high.y, low.z) * t.y;
    const double above = along_x(low.y, high.z) * (1.0 - t.y) + along_x(high.y, high.z) * t.y;
    return below * (1.0 - t.z) + above * t.z;
  }

  const Sample* samples_;
  glm::ivec3 dims_;
  glm::dmat4 scan_from_universe_;
  bool coincident_;
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

std::int16_t rounded(double value, const Scene& scene) {
  const double nearest = std::floor(value + 0.5);
  if (!(nearest >= std::numeric_limits<std::int16_t>::min() &&
        nearest <= std::numeric_limits<std::int16_t>::max()))
    throw std::invalid_argument(scene.source + ": the sample " + std::to_string(value) +
                                " does not fit into 16 bits: rescale the scan first");
  return static_cast<std::int16_t>(nearest);
}

template <typename Sample>
void fill(GreyBrick& brick, const glm::ivec3& origin, int side, const Resampler<Sample>& resampler,
          const Scene& scene, std::int16_t background) {
  for (int leaf = 0; leaf < 64; ++leaf) {
    const glm::ivec3 leaf_origin = origin + 4 * glm::ivec3(leaf & 3, (leaf >> 2) & 3, leaf >> 4);
    auto& samples = brick.samples[static_cast<std::size_t>(leaf)];
    for (int i = 0; i < 64; ++i) {
      const glm::ivec3 voxel = leaf_origin + glm::ivec3(i & 3, (i >> 2) & 3, i >> 4);
      const bool beyond = voxel.x >= side || voxel.y >= side || voxel.z >= side;
      samples[static_cast<std::size_t>(i)] =
          beyond ? background : rounded(resampler.value(voxel, background), scene);
    }
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
    brick.leaf_range[static_cast<std::size_t>(leaf)] = {*low, *high};
  }
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
  return bytes;
}

GreyOctree grey_octree_of(const Universe& universe, const Scene& scene, std::int16_t background) {
  check(scene);
  auto storage = std::make_shared<GreyOctree::Storage>();
  storage->universe = universe;
  storage->background = background;

  // 1. Number the bricks: 0 is background, then the blocks within reach, x fastest.
  GreyOctree::Level bottom;
  bottom.side = (universe.side() + 15) / 16;
  const auto block_count = static_cast<std::size_t>(bottom.side) * static_cast<std::size_t>(bottom.side) *
                           static_cast<std::size_t>(bottom.side);
  bottom.ranges.assign(block_count, {background, background});
  storage->brick_of_block.assign(block_count, 0);
  const auto [first_voxel, last_voxel] = reach(universe, scene.lattice);
  const glm::ivec3 first = first_voxel >> 4;
  const glm::ivec3 count = (last_voxel >> 4) - first + 1;
  std::uint32_t next = 1;
  for (int z = 0; z < count.z; ++z)
    for (int y = 0; y < count.y; ++y)
      for (int x = 0; x < count.x; ++x)
        storage->brick_of_block[bottom.index(first + glm::ivec3(x, y, z))] = next++;
  storage->bricks.resize(next);
  for (auto& leaf : storage->bricks.front().samples) leaf.fill(background);
  storage->bricks.front().leaf_range.fill({background, background});

  // 2. Fill them.
  std::visit(
      [&](const auto& samples) {
        const Resampler resampler(universe, scene.lattice, samples.data());
        tbb::parallel_for(0, count.y * count.z, [&](int row) {
          for (int x = 0; x < count.x; ++x) {
            const glm::ivec3 block = first + glm::ivec3(x, row % count.y, row / count.y);
            GreyBrick& brick = storage->bricks[storage->brick_of_block[bottom.index(block)]];
            fill(brick, block * 16, universe.side(), resampler, scene, background);
            MinMax& range = bottom.ranges[bottom.index(block)];
            range = brick.leaf_range.front();
            for (const MinMax& leaf : brick.leaf_range) widen(range, leaf);
          }
        });
      },
      scene.samples);
  storage->levels.push_back(std::move(bottom));

  // 3. Join the ranges.
  for (int height = 3; height <= root_height(universe.depth); ++height) {
    const GreyOctree::Level& below = storage->levels.back();
    GreyOctree::Level level;
    level.side = (below.side + 3) / 4;
    level.ranges.resize(static_cast<std::size_t>(level.side) * static_cast<std::size_t>(level.side) *
                        static_cast<std::size_t>(level.side));
    for (int z = 0; z < level.side; ++z)
      for (int y = 0; y < level.side; ++y)
        for (int x = 0; x < level.side; ++x) {
          const glm::ivec3 parent(x, y, z);
          MinMax range = below.ranges[below.index(parent * 4)];
          for (int child = 1; child < 64; ++child) {
            const glm::ivec3 at = parent * 4 + glm::ivec3(child & 3, (child >> 2) & 3, child >> 4);
            if (glm::all(glm::lessThan(at, glm::ivec3(below.side))))
              widen(range, below.ranges[below.index(at)]);
          }
          level.ranges[level.index(parent)] = range;
        }
    storage->levels.push_back(std::move(level));
  }
  return GreyOctree(std::move(storage));
}

}  // namespace octotomy::voxel
