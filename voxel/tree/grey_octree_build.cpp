// SPDX-License-Identifier: AGPL-3.0-or-later
#define TBB_PREVIEW_ISOLATED_TASK_GROUP 1
#include "voxel/tree/grey_octree_build.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <limits>
#include <mutex>
#include <tbb/task_group.h>
#include <unordered_map>
#include <utility>
#include <vector>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "voxel/space/vector_clones.h"
#include "voxel/tree/build.h"
#include "voxel/tree/octree_node.h"
#include "voxel/tree/scan_rows.h"

// Passes: 1 find the blocks that the scan reaches; 2 fill the blocks' bricks, the ranges of their leaves and
// the octree blocks of their voxels that lie in the scan, one row of blocks along x at a time, as soon as all
// slices that the row reads are final; 3 join the ranges level by level up to the root, and the octree blocks
// to the scan's octree.
//
// Memory dominates the time: mapping new pages takes longer than writing to them. So bricks of a single value
// are shared within a layer, and the other bricks of a row are contiguous. Samples that need no resampling
// are copied straight into bricks: for each run of blocks the ranges are computed first, line by line; then,
// while the run is in the cache, its samples are copied by stores that bypass the cache.

namespace octotomy::voxel {
namespace {

// The first and the last voxel of the universe along each axis that a scan can reach, clamped to the
// universe.
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

using LeafRanges = std::array<MinMax, 64>;

// Largest number of blocks along x in a run: its 256 rows of 512 samples stay in a cache of 256 KiB from the
// computation of the ranges to the copy.
constexpr std::size_t longest_run = 32;

// Extends the ranges of columns so that they include a row of samples.
OCTOTOMY_VECTOR_CLONES void widen(const std::int16_t* samples, std::size_t width, std::int16_t* low,
                                  std::int16_t* high) {
  for (std::size_t x = 0; x < width; ++x) {
    const std::int16_t sample = samples[x];
    low[x] = sample < low[x] ? sample : low[x];
    high[x] = sample > high[x] ? sample : high[x];
  }
}

// Computes the ranges of the leaves of a run of blocks along x; `first` is the run's first sample. Rows are
// read in the order in which they lie in memory.
void find_ranges(const std::int16_t* first, const RowSteps& steps, std::size_t count, LeafRanges* ranges) {
  const std::size_t width = 16 * count;
  for (std::size_t z = 0; z < 16; z += 4) {
    // Computes the ranges of single columns first, then joins four columns to a leaf.
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

// Copies a block's samples into a brick, ordered by leaves.
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

}  // namespace

class GreyOctreeBuild::Work {
 public:
  Work(const Universe& universe, const Scene& scene, std::int16_t background, double step)
      : reached_(universe, scene.lattice),
        rows_(universe, scene, background, step),
        storage_(std::make_shared<GreyOctree::Storage>(universe, background,
                                                       reached_.number({0, 0, reached_.count.z}))),
        scan_(reached_.number({0, 0, reached_.count.z})),
        shared_(static_cast<std::size_t>(reached_.count.z)) {
    storage_->step = step;
    for (int z = 0; z < reached_.count.z; ++z) {
      const int first = 16 * (reached_.first.z + z);
      layers_.emplace_back(rows_.slices_read(first, first + 15), z);
    }
    std::sort(layers_.begin(), layers_.end(), std::greater<>());
  }
  ~Work() {
    tasks_.cancel();
    try {
      tasks_.wait();
    } catch (...) {
      // The octree is discarded, so an error in building it is ignored.
    }
  }

  void add(int count);
  double built() {
    tasks_.wait();
    return 1.0 - static_cast<double>(layers_.size()) / static_cast<double>(shared_.size());
  }
  GreyOctree finished() {
    tasks_.wait();
    storage_->brick_count = 1 + brick_count_;
    storage_->scan = octree_of_blocks(storage_->universe, [&](const glm::ivec3& block) {
      const glm::ivec3 at = block - reached_.first;
      const bool is_reached =
          glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, reached_.count));
      return is_reached ? std::move(scan_[reached_.number(at)]) : Block();
    });
    storage_->join_ranges();
    return GreyOctree(std::move(storage_));
  }

 private:
  // The blocks that the scan reaches.
  struct Reached {
    Reached(const Universe& universe, const Lattice& lattice) {
      const auto [first_voxel, last_voxel] = reach(universe, lattice);
      first = first_voxel >> 4;
      count = (last_voxel >> 4) - first + 1;
    }
    std::size_t number(const glm::ivec3& at) const {
      const glm::uvec3 place(at), side(count);
      return place.x + std::size_t{side.x} * (place.y + std::size_t{side.y} * place.z);
    }
    glm::ivec3 first, count;
  };
  // The bricks with a single value, which the blocks of a layer share.
  struct Shared {
    std::mutex mutex;
    std::unordered_map<std::int16_t, std::uint32_t> bricks;
  };
  class Row;

  const Reached reached_;
  const ScanRows rows_;
  std::shared_ptr<GreyOctree::Storage> storage_;
  std::vector<Block> scan_;  // for each block the voxels that lie in the scan
  std::vector<Shared> shared_;
  // Layers that have not been begun, the next one last: number of slices that the layer reads, and its z.
  std::vector<std::pair<int, int>> layers_;
  std::atomic<std::size_t> brick_count_ = 0;
  tbb::isolated_task_group tasks_;  // the last member, so that the others outlive the tasks
};

// A row of blocks along x. Its bricks are contiguous, in a range reserved for the row.
class GreyOctreeBuild::Work::Row {
 public:
  Row(Work& work, int y, int z)
      : work_(work),
        y_(y),
        z_(z),
        scan_rows_(work.rows_),
        storage_(*work.storage_),
        next_(1 + static_cast<std::uint32_t>(work.reached_.number({0, y, z}))) {}

  void fill() {
    const std::uint32_t first = next_;
    const int end = work_.reached_.count.x;
    for (int x = 0; x < end;) {
      const glm::ivec3 at(x, y_, z_);
      const std::int16_t* const own = scan_samples(at);
      const auto is_alike = [&](int i) {
        return (scan_samples(at + glm::ivec3(i, 0, 0)) != nullptr) == (own != nullptr);
      };
      int count = 1;
      while (count < static_cast<int>(longest_run) && x + count < end && is_alike(count)) ++count;
      if (own != nullptr) {
        for (int i = 0; i < count; ++i) scan(at, i) = Block::adopt(BlockRef::full());
        place(at, count, own, scan_rows_.steps());
      } else {
        resample(at, count);
        place(at, count, samples_.data(), {16 * longest_run, 256 * longest_run});
      }
      x += count;
    }
#if defined(__SSE2__)
    _mm_sfence();  // orders the streaming stores before other threads read them
#endif
    work_.brick_count_ += next_ - first;
  }

 private:
  glm::ivec3 origin(const glm::ivec3& at) const {
    return 16 * (work_.reached_.first + at);
  }
  Block& scan(const glm::ivec3& at, int i) {
    return work_.scan_[work_.reached_.number(at + glm::ivec3(i, 0, 0))];
  }

  // A pointer to the scan's sample at a block's first voxel if all of the block's samples are samples of the
  // scan; otherwise null.
  const std::int16_t* scan_samples(const glm::ivec3& at) const {
    // In a smaller universe, blocks extend beyond the universe.
    return storage_.universe.side() < 16 ? nullptr : scan_rows_.own_samples(origin(at));
  }

  // Fills samples_ with the samples of `count` blocks along x, beginning at `at`.
  void resample(const glm::ivec3& at, int count) {
    samples_.resize(256 * 16 * longest_run);
    std::array<BlockRows, longest_run> inside{};
    const glm::ivec3 first = origin(at);
    const int side = storage_.universe.side();
    const auto within = static_cast<std::uint16_t>(0xffff >> std::max(0, 16 - side));
    std::int16_t* row = samples_.data();
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
      scan(at, i) = whole ? Block::adopt(BlockRef::full()) : leaf_block_of_rows(bits);
    }
  }

  // Assigns bricks to `count` blocks along x and fills them; `samples` is the first block's first sample.
  void place(const glm::ivec3& at, int count, const std::int16_t* samples, const RowSteps& steps) {
    std::array<LeafRanges, longest_run> ranges;
    find_ranges(samples, steps, static_cast<std::size_t>(count), ranges.data());
    for (int i = 0; i < count; ++i)
      if (GreyBrick* const brick = placed(at + glm::ivec3(i, 0, 0), ranges[static_cast<std::size_t>(i)]))
        copy_block(samples + 16 * i, steps, *brick);
  }

  // Assigns a brick to a block. If the brick's samples have yet to be written, stores its ranges and returns
  // the brick, otherwise null.
  GreyBrick* placed(const glm::ivec3& at, const LeafRanges& ranges) {
    GreyOctree::Level& bottom = storage_.bottom();
    const std::size_t index = bottom.index(work_.reached_.first + at);
    const MinMax range = bottom.ranges[index] = joined(ranges);
    std::uint32_t& number = storage_.brick_of_block[index];
    if (range.low == range.high) {
      if (range.low == storage_.background) return nullptr;  // the block refers to brick 0
      Shared& shared = work_.shared_[static_cast<std::size_t>(z_)];
      const std::lock_guard lock(shared.mutex);
      const auto [known, is_new] = shared.bricks.try_emplace(range.low, next_);
      number = known->second;
      if (!is_new) return nullptr;
    }
    number = next_++;
    GreyBrick& brick = storage_.bricks[number];
    brick.leaf_range = ranges;
    return &brick;
  }

  Work& work_;
  int y_, z_;
  const ScanRows& scan_rows_;
  GreyOctree::Storage& storage_;
  std::uint32_t next_;                 // number of the next brick
  std::vector<std::int16_t> samples_;  // samples of a run that is resampled, row by row, z after y
};

void GreyOctreeBuild::Work::add(int count) {
  for (; !layers_.empty() && layers_.back().first <= count; layers_.pop_back())
    for (int y = 0; y < reached_.count.y; ++y)
      tasks_.run([this, y, z = layers_.back().second] { Row(*this, y, z).fill(); });
}

GreyOctreeBuild::GreyOctreeBuild(const Universe& universe, const Scene& scene, std::int16_t background,
                                 double step)
    : work_(std::make_unique<Work>(
          universe, scene,
          static_cast<std::int16_t>(std::clamp(std::floor(background / step), -32768.0, 32767.0)), step)) {}

GreyOctreeBuild::~GreyOctreeBuild() = default;

void GreyOctreeBuild::add(int count) {
  work_->add(count);
}

double GreyOctreeBuild::built() {
  return work_->built();
}

GreyOctree GreyOctreeBuild::finished() {
  return work_->finished();
}

}  // namespace octotomy::voxel
