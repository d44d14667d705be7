// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/cell_counts.h"

#include <algorithm>
#include <bit>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <vector>

#include "voxel/tree/slice_bits.h"

namespace octotomy::voxel {
namespace {

using Counts = std::array<std::uint64_t, 256>;

// The rows of a slice, with an empty row before and after them, and an empty word after each row.
class PaddedSlice {
 public:
  explicit PaddedSlice(int side)
      : side_(side),
        words_(static_cast<std::size_t>((side + 63) / 64) + 1),
        bits_((static_cast<std::size_t>(side) + 2) * words_, 0) {}

  void read(const Octree& octree, int z) {
    std::fill(bits_.begin(), bits_.end(), 0);
    if (z < 0 || z >= side_) return;
    read_slice(octree, z, slice_);
    for (int y = 0; y < side_; ++y)
      std::copy_n(slice_.row(y), slice_.words_per_row, &bits_[static_cast<std::size_t>(y + 1) * words_]);
  }
  /// Row y, -1 to side.
  const std::uint64_t* row(int y) const { return &bits_[static_cast<std::size_t>(y + 1) * words_]; }
  std::size_t words() const { return words_; }

 private:
  int side_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
  SliceBits slice_;
};

// Counts the corners between slices `below` and `above` at the low side of row y. Their eight voxels are
// x - 1 and x of four rows.
void count_row(const PaddedSlice& below, const PaddedSlice& above, int y, Counts& counts) {
  const std::array<const std::uint64_t*, 4> rows{below.row(y - 1), below.row(y), above.row(y - 1),
                                                 above.row(y)};
  std::array<std::uint64_t, 4> carry{};
  for (std::size_t i = 0; i < below.words(); ++i) {
    std::array<std::uint64_t, 8> voxels;
    std::uint64_t any = 0;
    std::uint64_t every = all_children;
    for (std::size_t r = 0; r < 4; ++r) {
      const std::uint64_t here = rows[r][i];
      voxels[2 * r] = here << 1 | carry[r];
      voxels[2 * r + 1] = here;
      carry[r] = here >> 63;
      any |= voxels[2 * r] | here;
      every &= voxels[2 * r] & here;
    }
    for (std::uint64_t mixed = any & ~every; mixed != 0; mixed &= mixed - 1) {
      const int x = std::countr_zero(mixed);
      std::size_t pattern = 0;
      for (std::size_t v = 0; v < 8; ++v) pattern |= ((voxels[v] >> x) & 1) << v;
      ++counts[pattern];
    }
  }
}

// Eight times the contribution of a corner of the pattern to each Euler number: 8 corners share a voxel, 4 a
// face, 2 an edge.
struct Share {
  int by_faces = 0;
  int by_corners = 0;
};

Share share_of(unsigned pattern) {
  const auto tally = [&](unsigned mask, int& every, int& any) {
    every += (pattern & mask) == mask;
    any += (pattern & mask) != 0;
  };
  int pairs = 0, pairs_any = 0, quads = 0, quads_any = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned step = 1U << axis;
    for (unsigned v = 0; v < 8; ++v)
      if ((v & step) == 0) tally(1U << v | 1U << (v | step), pairs, pairs_any);
    // The four voxels on one side of the corner along the axis surround an edge at the corner.
    unsigned low = 0;
    for (unsigned v = 0; v < 8; ++v)
      if ((v & step) == 0) low |= 1U << v;
    tally(low, quads, quads_any);
    tally(~low & 255U, quads, quads_any);
  }
  const int voxels = std::popcount(pattern);
  const int octets = pattern == 255U;
  const int octets_any = pattern != 0U;
  return {voxels - 2 * pairs + 4 * quads - 8 * octets,
          8 * octets_any - 4 * quads_any + 2 * pairs_any - voxels};
}

}  // namespace

std::array<std::uint64_t, 256> cell_counts(const Octree& octree) {
  const int side = octree.universe().side();
  return tbb::parallel_reduce(
      tbb::blocked_range<int>(0, side + 1, 16), Counts{},
      [&](const tbb::blocked_range<int>& part, Counts counts) {
        PaddedSlice below(side);
        PaddedSlice above(side);
        below.read(octree, part.begin() - 1);
        for (int z = part.begin(); z < part.end(); ++z) {
          above.read(octree, z);
          for (int y = 0; y <= side; ++y) count_row(below, above, y, counts);
          std::swap(below, above);
        }
        return counts;
      },
      [](Counts a, const Counts& b) {
        for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
        return a;
      });
}

EulerNumbers euler_numbers(const Octree& octree) {
  const Counts counts = cell_counts(octree);
  EulerNumbers eightfold;
  for (unsigned pattern = 1; pattern < 255; ++pattern) {
    const Share share = share_of(pattern);
    eightfold.by_faces += share.by_faces * static_cast<std::int64_t>(counts[pattern]);
    eightfold.by_corners += share.by_corners * static_cast<std::int64_t>(counts[pattern]);
  }
  return {eightfold.by_faces / 8, eightfold.by_corners / 8};
}

}  // namespace octotomy::voxel
