// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/components.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "voxel/build.h"
#include "voxel/slice_bits.h"

// Source: He, Chao, Suzuki 2008, run-based labelling, in three dimensions: runs of voxels along x are the
// units; a run joins those of the row before and of the slice before that share an x with it. The memory is
// that of the runs, which follow the boundary.

namespace octotomy::voxel {
namespace {

struct Run {
  int first = 0;
  int last = 0;
};

// Runs of a whole octree, row by row: rows are numbered y + side * z.
struct Runs {
  int side = 0;
  std::vector<Run> runs;
  std::vector<std::size_t> row_start;  ///< one more than there are rows

  std::size_t begin(int y, int z) const { return row_start[index(y, z)]; }
  std::size_t end(int y, int z) const { return row_start[index(y, z) + 1]; }

 private:
  std::size_t index(int y, int z) const {
    return static_cast<std::size_t>(z) * static_cast<std::size_t>(side) + static_cast<std::size_t>(y);
  }
};

void append_runs(const std::uint64_t* row, int words, std::vector<Run>& runs) {
  bool open = false;
  for (int i = 0; i < words; ++i) {
    // Bits where the row changes between voxel x - 1 and x.
    std::uint64_t changes = row[i] ^ (row[i] << 1 | (open ? 1 : 0));
    for (; changes != 0; changes &= changes - 1) {
      const int x = 64 * i + std::countr_zero(changes);
      if (open)
        runs.back().last = x - 1;
      else
        runs.push_back({x, x});
      open = !open;
    }
  }
  if (open) runs.back().last = 64 * words - 1;
}

Runs runs_of(const Octree& octree) {
  Runs result;
  result.side = octree.universe().side();
  SliceBits slice;
  for (int z = 0; z < result.side; ++z) {
    read_slice(octree, z, slice);
    for (int y = 0; y < result.side; ++y) {
      result.row_start.push_back(result.runs.size());
      append_runs(slice.row(y), slice.words_per_row, result.runs);
    }
  }
  result.row_start.push_back(result.runs.size());
  return result;
}

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // The smaller number stays the root, so that a part is named by its first run.
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

void join_overlaps(const Runs& runs, int y, int z, int other_y, int other_z, DisjointSets& sets) {
  if (other_y < 0 || other_z < 0) return;
  std::size_t a = runs.begin(y, z);
  std::size_t b = runs.begin(other_y, other_z);
  while (a < runs.end(y, z) && b < runs.end(other_y, other_z)) {
    const Run& own = runs.runs[a];
    const Run& other = runs.runs[b];
    if (own.first <= other.last && other.first <= own.last)
      sets.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    own.last < other.last ? ++a : ++b;
  }
}

// The block of 16 voxels a side of the runs of one part.
Block block_of_part(const Runs& runs, const std::vector<std::uint32_t>& part, std::uint32_t wanted,
                    const glm::ivec3& block) {
  std::uint64_t words[64] = {};
  bool any = false;
  for (int z = 0; z < 16; ++z)
    for (int y = 0; y < 16; ++y) {
      const glm::ivec3 at = block * 16 + glm::ivec3(0, y, z);
      if (at.y >= runs.side || at.z >= runs.side) continue;
      const auto row = runs.runs.begin();
      const auto end = row + static_cast<std::ptrdiff_t>(runs.end(at.y, at.z));
      auto run = std::lower_bound(row + static_cast<std::ptrdiff_t>(runs.begin(at.y, at.z)), end, at.x,
                                  [](const Run& r, int x) { return r.last < x; });
      for (; run != end && run->first < at.x + 16; ++run) {
        if (part[static_cast<std::size_t>(run - row)] != wanted) continue;
        const int first = std::max(run->first - at.x, 0);
        const int last = std::min(run->last - at.x, 15);
        for (int x = first; x <= last; ++x)
          words[child_index(x >> 2, y >> 2, z >> 2)] |= std::uint64_t{1} << child_index(x & 3, y & 3, z & 3);
        any = true;
      }
    }
  return any ? make_leaf_block(0, all_children, words) : Block();
}

}  // namespace

Components components(const Octree& octree) {
  const Runs runs = runs_of(octree);
  DisjointSets sets(runs.runs.size());
  for (int z = 0; z < runs.side; ++z)
    for (int y = 0; y < runs.side; ++y) {
      join_overlaps(runs, y, z, y - 1, z, sets);
      join_overlaps(runs, y, z, y, z - 1, sets);
    }

  std::vector<std::uint32_t> part(runs.runs.size());
  std::vector<std::uint64_t> size(runs.runs.size(), 0);
  std::vector<std::uint32_t> firsts;
  for (std::uint32_t i = 0; i < part.size(); ++i) {
    part[i] = sets.find(i);
    if (part[i] == i) firsts.push_back(i);
    size[part[i]] += static_cast<std::uint64_t>(runs.runs[i].last - runs.runs[i].first + 1);
  }
  std::stable_sort(firsts.begin(), firsts.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return size[a] > size[b]; });

  Components result{{}, Octree::empty(octree.universe())};
  for (const std::uint32_t first : firsts) result.voxel_counts.push_back(size[first]);
  if (!firsts.empty())
    result.largest = octree_of_blocks(octree.universe(), [&](const glm::ivec3& block) {
      return block_of_part(runs, part, firsts.front(), block);
    });
  return result;
}

}  // namespace octotomy::voxel
