// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "voxel/space/large_allocator.h"
#include "voxel/space/lattice.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Smallest and largest sample of a block. Without default values, so that bricks are first touched by the
/// threads that fill them.
struct MinMax {
  std::int16_t low;
  std::int16_t high;

  void widen(const MinMax& by) {
    low = std::min(low, by.low);
    high = std::max(high, by.high);
  }
};

/// The range of all.
inline MinMax joined(const std::array<MinMax, 64>& ranges) {
  MinMax whole = ranges.front();
  for (const MinMax& range : ranges) whole.widen(range);
  return whole;
}

/// Status of a block whose values lie in a range, seen through the window low..high, both included.
template <typename Range>
Status window_status(const Range& range, double low, double high) {
  if (range.low >= low && range.high <= high) return Status::Full;
  return range.high < low || range.low > high ? Status::Empty : Status::Partial;
}

/// Samples of a block of 16 x 16 x 16 voxels: 64 leaves of 4 x 4 x 4, leaves and the samples within each in
/// bit order (octree_node.h), so that a window of a leaf is one 64-bit word.
struct GreyBrick {
  std::array<MinMax, 64> leaf_range;
  std::array<std::array<std::int16_t, 64>, 64> samples;
};

/// A min-max octree of int16 samples over dense leaves (thesis 3.3.2, the hybrid tree of A.6). A window
/// chosen later makes an object of it. Voxels beyond the scan have the background as their sample and belong
/// to no window. A sample counts steps of step(), which is one in the scan's own unit where its samples are
/// whole numbers of 16 bits. Immutable; copies share.
class GreyOctree {
 public:
  const Universe& universe() const { return storage_->universe; }
  /// Value of voxels beyond the scan.
  std::int16_t background() const { return storage_->background; }
  /// What a step of the samples is in the scan's unit: a power of two.
  double step() const { return storage_->step; }
  /// A value in the scan's unit as samples count: rounded as they are, where they are.
  double in_steps(double value) const { return step() == 1.0 ? value : std::floor(value / step() + 0.5); }
  /// The voxels whose sample is the scan's own.
  const Octree& scan() const { return storage_->scan; }
  /// Whether voxels beyond the scan have samples in low..high. If so, samples alone do not tell the window's
  /// voxels.
  bool window_meets_background(double low, double high) const {
    return low <= background() && background() <= high;
  }

  /// Range of block number `block` of the given height, 2 and up; blocks of a height form a grid of
  /// universe side / 4^height, rounded up, along each axis. Precondition: within that grid.
  const MinMax& range(int height, const glm::ivec3& block) const {
    assert(height >= 2 && static_cast<std::size_t>(height) < storage_->levels.size() + 2);
    const Level& level = storage_->levels[static_cast<std::size_t>(height - 2)];
    return level.ranges[level.index(block)];
  }
  /// Samples of block number `block` of height 2. Blocks of one value may share a brick. Precondition: within
  /// the grid.
  const GreyBrick& brick(const glm::ivec3& block) const {
    return storage_->bricks[storage_->brick_of_block[storage_->levels.front().index(block)]];
  }
  /// The sample of a voxel; outside the universe, the background.
  std::int16_t sample(const glm::ivec3& voxel) const;
  std::uint64_t bytes_memory() const;

  /// A copy that keeps the scan that it was made of, for on_scan_lattice().
  GreyOctree with_scan(std::shared_ptr<const Scene> scene) const;
  /// The same scan's samples on the scan's own lattice. A window under a motion is read from them, because
  /// voxels that were interpolated already would be interpolated a second time, which loses thin walls. This
  /// octree itself where the lattices coincide, no scan is kept or the scan is larger than a universe. The
  /// first call builds it; later ones return the same. Any number of threads may call it.
  const GreyOctree& on_scan_lattice() const;

 private:
  friend class GreyOctreeBuild;
  friend GreyOctree grey_octree_of_bricks(const Universe&, std::int16_t, std::span<const glm::ivec3>,
                                          const std::function<void(std::size_t, GreyBrick&)>&,
                                          std::optional<Octree>, double);
  struct Level {
    int side = 1;  ///< blocks along an axis
    std::vector<MinMax> ranges;
    std::size_t index(const glm::ivec3& block) const {
      assert(glm::all(glm::greaterThanEqual(block, glm::ivec3(0))) &&
             glm::all(glm::lessThan(block, glm::ivec3(side))));
      const auto blocks = static_cast<std::size_t>(side);
      return static_cast<std::size_t>(block.x) +
             blocks * (static_cast<std::size_t>(block.y) + blocks * static_cast<std::size_t>(block.z));
    }
  };
  struct Storage {
    /// All background: brick 0, and room for others.
    Storage(const Universe& universe, std::int16_t background, std::size_t brick_count);
    Level& bottom() { return levels.front(); }
    /// Adds the levels above the bottom one.
    void join_ranges();

    Universe universe;
    std::int16_t background;
    double step = 1.0;
    Octree scan = Octree::empty({});
    std::vector<Level> levels;                  ///< heights 2, 3, ... up to the root's
    std::vector<std::uint32_t> brick_of_block;  ///< brick 0 is all background
    /// With gaps: a brick that no block has was never touched, and takes no memory but within a page.
    std::vector<GreyBrick, LargeAllocator<GreyBrick>> bricks;
    std::size_t brick_count = 0;  ///< of those that blocks have, and brick 0
  };
  explicit GreyOctree(std::shared_ptr<const Storage> storage) : storage_(std::move(storage)) {}
  struct KeptScan;
  std::shared_ptr<const Storage> storage_;
  std::shared_ptr<KeptScan> kept_;  ///< none: no scan, or one whose lattice is the universe's
};

/// What voxels outside of a scan hold by default: below any CT sample.
inline constexpr std::int16_t beyond_scan = -1024;

/// The step in which a grey octree holds a scan's samples: 1 where they are whole numbers of 16 bits, else
/// the least power of two of which the largest measured sample is at most 32,000. Cost: of float samples one
/// pass.
double grey_step(const Scene& scene);

/// Samples the scene at the universe's voxel centres: exactly if the lattices coincide, otherwise by
/// trilinear interpolation; rounded to the nearest grey_step(), halves upward. Voxels whose centre lies
/// outside the scene's bounds, or whose sample would be made of the scene's padding, become `background`, in
/// the scan's unit, and are no part of scan(): no window holds them. Throws Stopped. Parallel; same bits on
/// any thread count. GreyOctreeBuild (grey_octree_build.h) makes it while the scan is read. Memory: the
/// samples within the scan's bounds and three per cent, without blocks of 16 x 16 x 16 voxels that have one
/// value, as air beside a head has.
GreyOctree grey_octree_of(const Universe& universe, const Scene& scene, std::int16_t background = beyond_scan,
                          const Progress& progress = {});

/// The grey octree whose blocks of height 2 numbered `blocks` have samples and whose others are background.
/// `fill` sets the samples of brick `number`, that of blocks[number], and is called once each from several
/// threads; ranges are made here. Samples beyond a universe of less than 16 voxels a side must be the
/// background. `scan` are the voxels whose samples are the scan's; none: scan_box(). Throws
/// std::invalid_argument if a block is outside the universe or named twice, or the scan is of another
/// universe.
GreyOctree grey_octree_of_bricks(const Universe& universe, std::int16_t background,
                                 std::span<const glm::ivec3> blocks,
                                 const std::function<void(std::size_t number, GreyBrick& brick)>& fill,
                                 std::optional<Octree> scan = std::nullopt, double step = 1.0);

/// The smallest box that holds every sample other than the background: the scan's voxels as far as samples
/// tell. Cost: the ranges of blocks, and the samples of those that the box's faces cut.
Octree scan_box(const GreyOctree& grey);

}  // namespace octotomy::voxel
