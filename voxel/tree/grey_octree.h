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

/// The smallest and the largest sample of a block. There are no default values, because the thread that fills
/// a brick must be the first to write to the brick's memory.
struct MinMax {
  std::int16_t low;
  std::int16_t high;

  void widen(const MinMax& by) {
    low = std::min(low, by.low);
    high = std::max(high, by.high);
  }
};

/// The union of 64 ranges.
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

/// The samples of a block of 16 x 16 x 16 voxels: 64 leaves of 4 x 4 x 4. The leaves and the samples within a
/// leaf are in bit order (octree_node.h), so that a window's voxels in a leaf form one 64-bit word.
struct GreyBrick {
  std::array<MinMax, 64> leaf_range;
  std::array<std::array<std::int16_t, 64>, 64> samples;
};

/// A min-max octree of int16 samples over dense leaves (thesis 3.3.2, the hybrid tree of A.6). A window
/// chosen later selects an object from it. Voxels beyond the scan have the background as their sample and
/// belong to no window. Samples are multiples of step(), which is in the scan's unit; the step is 1 if the
/// scan's samples are integers that fit into 16 bits. Immutable; copies share their data.
class GreyOctree {
 public:
  const Universe& universe() const { return storage_->universe; }
  /// The sample of voxels beyond the scan, in steps.
  std::int16_t background() const { return storage_->background; }
  /// The size of one step of the samples in the scan's unit: a power of two.
  double step() const { return storage_->step; }
  /// Converts a value from the scan's unit to steps. If the step is 1, returns the value; otherwise rounds it
  /// to a step as samples are rounded.
  double in_steps(double value) const { return step() == 1.0 ? value : std::floor(value / step() + 0.5); }
  /// The voxels whose sample comes from the scan.
  const Octree& scan() const { return storage_->scan; }
  /// Whether the background lies in low..high. If so, samples alone do not determine the window's voxels,
  /// which exclude those beyond the scan.
  bool window_meets_background(double low, double high) const {
    return low <= background() && background() <= high;
  }

  /// The range of the samples in block number `block` of the given height, 2 or more, in steps. Along each
  /// axis there are (universe side / 4^height) blocks, rounded up. Precondition: the block is one of them.
  const MinMax& range(int height, const glm::ivec3& block) const {
    assert(height >= 2 && static_cast<std::size_t>(height) < storage_->levels.size() + 2);
    const Level& level = storage_->levels[static_cast<std::size_t>(height - 2)];
    return level.ranges[level.index(block)];
  }
  /// The samples of block number `block` of height 2. Blocks of a single value may share a brick.
  /// Precondition: that of range().
  const GreyBrick& brick(const glm::ivec3& block) const {
    return storage_->bricks[storage_->brick_of_block[storage_->levels.front().index(block)]];
  }
  /// The sample of a voxel, in steps; outside the universe, the background.
  std::int16_t sample(const glm::ivec3& voxel) const;
  std::uint64_t bytes_memory() const;

  /// A copy that also stores the scan from which the octree was built, for on_scan_lattice().
  GreyOctree with_scan(std::shared_ptr<const Scene> scene) const;
  /// The samples of the scan on the scan's own lattice. Samples of a window under a motion are read from
  /// these, because a second interpolation of interpolated voxels would lose thin walls. Returns this octree
  /// itself if the lattices coincide, no scan is stored or the scan is larger than a universe. The first call
  /// builds the result; later ones return the same. Any number of threads may call it.
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
    /// At first all blocks refer to brick 0, which contains only the background. Reserves room for
    /// `brick_count` more bricks.
    Storage(const Universe& universe, std::int16_t background, std::size_t brick_count);
    Level& bottom() { return levels.front(); }
    /// Computes the ranges of all heights above the lowest.
    void join_ranges();

    Universe universe;
    std::int16_t background;
    double step = 1.0;
    Octree scan = Octree::empty({});
    std::vector<Level> levels;  ///< blocks' ranges at heights 2, 3, ... up to the root's
    /// Number of each block's brick; brick 0 contains only the background.
    std::vector<std::uint32_t> brick_of_block;
    /// Samples by brick number; some numbers may be unused. An unused brick is never written, so it takes
    /// memory only if it shares a page with a used one.
    std::vector<GreyBrick, LargeAllocator<GreyBrick>> bricks;
    std::size_t brick_count = 0;  ///< number of bricks in use, brick 0 included
  };
  explicit GreyOctree(std::shared_ptr<const Storage> storage) : storage_(std::move(storage)) {}
  struct KeptScan;
  std::shared_ptr<const Storage> storage_;
  /// Null if no scan is stored, or if on_scan_lattice() returns this octree.
  std::shared_ptr<KeptScan> kept_;
};

/// The default sample, in the scan's unit, of voxels outside a scan: below any CT sample.
inline constexpr std::int16_t beyond_scan = -1024;

/// The step in which a grey octree stores a scan's samples: 1 if they are integers that fit into 16 bits,
/// otherwise the least power of two for which the largest measured magnitude is at most 32,000 steps. Cost:
/// one pass over float samples.
double grey_step(const Scene& scene);

/// Samples the scene at the universe's voxel centres: exactly if the lattices coincide, otherwise by
/// trilinear interpolation; rounded to the nearest grey_step(), halves upward. Voxels whose centre lies
/// outside the scene's bounds, or whose sample would depend on the scene's padding, become `background`, in
/// the scan's unit, and are not part of scan(), so no window contains them. Throws Stopped. Parallel; same
/// bits on any thread count. GreyOctreeBuild (grey_octree_build.h) builds it while the scan is being read.
/// Memory: the samples within the scan's bounds plus three per cent. Blocks of 16 x 16 x 16 voxels with a
/// single value, such as air beside a head, take almost no memory.
GreyOctree grey_octree_of(const Universe& universe, const Scene& scene, std::int16_t background = beyond_scan,
                          const Progress& progress = {});

/// The grey octree with samples in the blocks of height 2 numbered `blocks` and the background elsewhere.
/// `fill` sets the samples of the brick of blocks[number]; it is called once per brick, from several threads.
/// The blocks' ranges are computed by this function. Samples beyond a universe of less than 16 voxels a side
/// must be the background. `scan` contains the voxels whose samples belong to the scan; default: scan_box().
/// Throws std::invalid_argument if a block is outside the universe or occurs twice, or `scan` has another
/// universe.
GreyOctree grey_octree_of_bricks(const Universe& universe, std::int16_t background,
                                 std::span<const glm::ivec3> blocks,
                                 const std::function<void(std::size_t number, GreyBrick& brick)>& fill,
                                 std::optional<Octree> scan = std::nullopt, double step = 1.0);

/// The smallest box that contains every sample other than the background: the best estimate of the scan's
/// voxels from samples alone. Cost: reads the ranges of blocks, and the samples of blocks that the box's
/// faces cut.
Octree scan_box(const GreyOctree& grey);

}  // namespace octotomy::voxel
