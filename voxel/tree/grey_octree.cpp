// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/grey_octree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <vector>

#include "voxel/space/error.h"
#include "voxel/tree/build.h"
#include "voxel/tree/grey_octree_build.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {
namespace {

void set_leaf_ranges(GreyBrick& brick) {
  for (std::size_t leaf = 0; leaf < 64; ++leaf) {
    MinMax range{brick.samples[leaf][0], brick.samples[leaf][0]};
    for (const std::int16_t sample : brick.samples[leaf]) range.widen({sample, sample});
    brick.leaf_range[leaf] = range;
  }
}

}  // namespace

GreyOctree::Storage::Storage(const Universe& given, std::int16_t value, std::size_t most_bricks)
    : universe(given), background(value), bricks(most_bricks + 1), brick_count(most_bricks + 1) {
  Level bottom;
  bottom.side = (universe.side() + 15) / 16;
  const auto side = static_cast<std::size_t>(bottom.side);
  bottom.ranges.assign(side * side * side, {background, background});
  levels.push_back(std::move(bottom));
  brick_of_block.assign(side * side * side, 0);
  for (auto& leaf : bricks.front().samples) leaf.fill(background);
  bricks.front().leaf_range.fill({background, background});
}

void GreyOctree::Storage::join_ranges() {
  for (int height = 3; height <= root_height(universe.depth); ++height) {
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

struct GreyOctree::KeptScan {
  std::shared_ptr<const Scene> scene;
  std::once_flag once;
  std::optional<GreyOctree> grey;
};

GreyOctree GreyOctree::with_scan(std::shared_ptr<const Scene> scene) const {
  GreyOctree made = *this;
  made.kept_.reset();
  const glm::ivec3 dims = scene->lattice.dims;
  const bool is_same =
      whole_voxel_offset(glm::inverse(scene->lattice.lps_from_voxel) * universe().lps_from_voxel).has_value();
  if (is_same || std::max({dims.x, dims.y, dims.z}) > 1 << Universe::max_depth) return made;
  made.kept_ = std::make_shared<KeptScan>();
  made.kept_->scene = std::move(scene);
  return made;
}

const GreyOctree& GreyOctree::on_scan_lattice() const {
  if (kept_ == nullptr) return *this;
  std::call_once(kept_->once, [&] {
    const Lattice& lattice = kept_->scene->lattice;
    Universe own{2, lattice.lps_from_voxel};
    while (own.side() < std::max({lattice.dims.x, lattice.dims.y, lattice.dims.z})) ++own.depth;
    GreyOctreeBuild build(own, *kept_->scene, background(), step());
    build.add(lattice.dims.z);
    kept_->grey = build.finished();
  });
  return *kept_->grey;
}

double grey_step(const Scene& scene) {
  const auto* samples = std::get_if<FloatSamples>(&scene.samples);
  if (samples == nullptr) return 1.0;
  bool fit = true;  // integers that fit into 16 bits
  double most = 0.0;
  for (const float sample : *samples) {
    const auto value = static_cast<double>(sample);
    if (!std::isfinite(value) || (scene.padding && value == *scene.padding)) continue;
    fit = fit && value == std::floor(value) && value >= std::numeric_limits<std::int16_t>::min() &&
          value <= std::numeric_limits<std::int16_t>::max();
    most = std::max(most, std::abs(value));
  }
  if (fit) return 1.0;
  constexpr double most_steps = 32000.0;
  return std::exp2(std::ceil(std::log2(most / most_steps)));
}

GreyOctree grey_octree_of(const Universe& universe, const Scene& scene, std::int16_t background,
                          const Progress& progress) {
  check(scene);
  GreyOctreeBuild build(universe, scene, background, grey_step(scene));
  // Every progress report waits for all threads, so there are at most 50 reports.
  const int slices = scene.lattice.dims.z, reports = progress.report ? std::min(slices, 50) : 1;
  for (int i = 1; i <= reports; ++i) {
    build.add(slices * i / reports);
    progress.at(i < reports ? build.built() : 1.0);
  }
  return build.finished();
}

GreyOctree grey_octree_of_bricks(const Universe& universe, std::int16_t background,
                                 std::span<const glm::ivec3> blocks,
                                 const std::function<void(std::size_t number, GreyBrick& brick)>& fill,
                                 std::optional<Octree> scan, double step) {
  if (scan && !(scan->universe() == universe))
    throw InvalidInput("the scan's voxels and the bricks have different universes");
  auto storage = std::make_shared<GreyOctree::Storage>(universe, background, blocks.size());
  storage->step = step;
  GreyOctree::Level& bottom = storage->bottom();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const glm::ivec3& block = blocks[i];
    if (glm::any(glm::lessThan(block, glm::ivec3(0))) ||
        glm::any(glm::greaterThanEqual(block, glm::ivec3(bottom.side))))
      throw InvalidInput("a brick lies outside the universe");
    std::uint32_t& brick = storage->brick_of_block[bottom.index(block)];
    if (brick != 0) throw InvalidInput("two bricks have the same block");
    brick = static_cast<std::uint32_t>(i + 1);
  }
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
    GreyBrick& brick = storage->bricks[i + 1];
    fill(i, brick);
    set_leaf_ranges(brick);
    bottom.ranges[bottom.index(blocks[i])] = joined(brick.leaf_range);
  });
  storage->join_ranges();
  const GreyOctree grey(storage);
  storage->scan = scan ? std::move(*scan) : scan_box(grey);
  return grey;
}

namespace {

// The bounding box of the samples that differ from the background. add() extends the box by a block of the
// given height; height 1 is a leaf and height 0 a voxel.
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
