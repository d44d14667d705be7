// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/components.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>

#include "voxel/tree/build.h"
#include "voxel/tree/slice_build.h"

// Source: run-based labelling by He, Chao and Suzuki 2008, in three dimensions. The units are runs of voxels
// along x. A run is joined to the runs of earlier rows, in its slice and in the slice before, that overlap it
// in x or are separated from it by at most the neighbourhood's gap.

namespace octotomy::voxel {
namespace {

struct Run {
  int first = 0;
  int last = 0;
};

// The runs of an octree, row by row; rows are numbered y + side * z.
struct Runs {
  int side = 0;
  std::vector<Run> runs;
  std::vector<std::size_t> row_start;  ///< index of each row's first run; a last entry is the number of runs

  std::size_t begin(int y, int z) const { return row_start[index(y, z)]; }
  std::size_t end(int y, int z) const { return row_start[index(y, z) + 1]; }

 private:
  std::size_t index(int y, int z) const {
    return static_cast<std::size_t>(z) * static_cast<std::size_t>(side) + static_cast<std::size_t>(y);
  }
};

Runs runs_of(const Octree& octree) {
  Runs result;
  result.side = octree.universe().side();
  SliceBits slice;
  for (int z = 0; z < result.side; ++z) {
    read_slice(octree, z, slice);
    for (int y = 0; y < result.side; ++y) {
      result.row_start.push_back(result.runs.size());
      Run run{0, -1};
      while (next_run(slice, y, run.last + 1, run.first, run.last)) result.runs.push_back(run);
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
  // The smaller number remains the root, so a component has the number of its first run.
  void join(std::uint32_t a, std::uint32_t b) {
    assert(a < parent_.size() && b < parent_.size());
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

// Joins the runs of a row with the runs of an earlier row whose ends are at most `gap` voxels away along x.
void join_rows(const Runs& runs, const glm::ivec2& row, const glm::ivec2& earlier, int gap,
               DisjointSets& sets) {
  assert(gap >= 0 && gap <= 1);
  if (earlier.x < 0 || earlier.x >= runs.side || earlier.y < 0) return;
  std::size_t a = runs.begin(row.x, row.y);
  std::size_t b = runs.begin(earlier.x, earlier.y);
  while (a < runs.end(row.x, row.y) && b < runs.end(earlier.x, earlier.y)) {
    const Run& own = runs.runs[a];
    const Run& other = runs.runs[b];
    if (own.first <= other.last + gap && other.first <= own.last + gap)
      sets.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    own.last < other.last ? ++a : ++b;
  }
}

// For each run the component's number, which is that of its first run, and under these numbers the
// components' voxel counts.
struct Parts {
  Runs runs;
  std::vector<std::uint32_t> part;
  std::vector<std::uint64_t> voxel_count;
};

Parts parts_of(const Octree& octree, Neighbours neighbours) {
  Parts parts{runs_of(octree), {}, {}};
  const Runs& runs = parts.runs;
  DisjointSets sets(runs.runs.size());
  // The largest differences in x at which runs are joined, for rows that share a face and for rows that share
  // an edge.
  const int across_face = neighbours == Neighbours::Faces ? 0 : 1;
  const int across_edge = neighbours == Neighbours::Corners ? 1 : 0;
  for (int z = 0; z < runs.side; ++z)
    for (int y = 0; y < runs.side; ++y) {
      join_rows(runs, {y, z}, {y - 1, z}, across_face, sets);
      join_rows(runs, {y, z}, {y, z - 1}, across_face, sets);
      if (neighbours == Neighbours::Faces) continue;
      join_rows(runs, {y, z}, {y - 1, z - 1}, across_edge, sets);
      join_rows(runs, {y, z}, {y + 1, z - 1}, across_edge, sets);
    }
  parts.part.resize(runs.runs.size());
  parts.voxel_count.resize(runs.runs.size(), 0);
  for (std::uint32_t i = 0; i < parts.part.size(); ++i) {
    parts.part[i] = sets.find(i);
    parts.voxel_count[parts.part[i]] +=
        static_cast<std::uint64_t>(runs.runs[i].last - runs.runs[i].first + 1);
  }
  return parts;
}

// A block of 16 x 16 x 16 voxels of the wanted parts.
Block block_of_parts(const Parts& parts, const std::vector<bool>& wanted, const glm::ivec3& block) {
  const Runs& runs = parts.runs;
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
        if (!wanted[parts.part[static_cast<std::size_t>(run - row)]]) continue;
        const int first = std::max(run->first - at.x, 0);
        const int last = std::min(run->last - at.x, 15);
        for (int x = first; x <= last; ++x)
          words[child_index(x >> 2, y >> 2, z >> 2)] |= std::uint64_t{1} << child_index(x & 3, y & 3, z & 3);
        any = true;
      }
    }
  return any ? make_leaf_block(0, all_children, words) : Block();
}

Octree octree_of_parts(const Octree& octree, const Parts& parts, const std::vector<bool>& wanted) {
  return octree_of_blocks(octree.universe(),
                          [&](const glm::ivec3& block) { return block_of_parts(parts, wanted, block); });
}

}  // namespace

Components components(const Octree& octree, Neighbours neighbours) {
  const Parts parts = parts_of(octree, neighbours);
  std::vector<std::uint32_t> firsts;
  for (std::uint32_t i = 0; i < parts.part.size(); ++i)
    if (parts.part[i] == i) firsts.push_back(i);
  std::stable_sort(firsts.begin(), firsts.end(), [&](std::uint32_t a, std::uint32_t b) {
    return parts.voxel_count[a] > parts.voxel_count[b];
  });
  Components result{{}, Octree::empty(octree.universe())};
  for (const std::uint32_t first : firsts) result.voxel_counts.push_back(parts.voxel_count[first]);
  if (firsts.empty()) return result;
  std::vector<bool> wanted(parts.part.size(), false);
  wanted[firsts.front()] = true;
  result.largest = octree_of_parts(octree, parts, wanted);
  return result;
}

std::size_t component_count(const Octree& octree, Neighbours neighbours) {
  const Parts parts = parts_of(octree, neighbours);
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < parts.part.size(); ++i) count += parts.part[i] == i;
  return count;
}

Octree components_at(const Octree& octree, const std::vector<glm::ivec3>& seeds, Neighbours neighbours) {
  const Parts parts = parts_of(octree, neighbours);
  std::vector<bool> wanted(parts.part.size(), false);
  for (const glm::ivec3& seed : seeds) {
    if (!octree.contains(seed)) continue;
    std::size_t run = parts.runs.begin(seed.y, seed.z);
    while (parts.runs.runs[run].last < seed.x) ++run;
    wanted[parts.part[run]] = true;
  }
  return octree_of_parts(octree, parts, wanted);
}

Octree components_that_meet(const Octree& octree, const Octree& other, Neighbours neighbours) {
  assert(octree.universe() == other.universe());
  const Parts parts = parts_of(octree, neighbours);
  const Runs others = runs_of(other);
  std::vector<bool> wanted(parts.part.size(), false);
  for (int z = 0; z < others.side; ++z)
    for (int y = 0; y < others.side; ++y) {
      std::size_t own = parts.runs.begin(y, z), theirs = others.begin(y, z);
      while (own < parts.runs.end(y, z) && theirs < others.end(y, z)) {
        const Run &a = parts.runs.runs[own], &b = others.runs[theirs];
        if (a.first <= b.last && b.first <= a.last) wanted[parts.part[own]] = true;
        a.last < b.last ? ++own : ++theirs;
      }
    }
  return octree_of_parts(octree, parts, wanted);
}

Octree components_of_at_least(const Octree& octree, std::uint64_t voxel_count, Neighbours neighbours) {
  const Parts parts = parts_of(octree, neighbours);
  std::vector<bool> wanted(parts.part.size(), false);
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = parts.voxel_count[i] >= voxel_count;
  return octree_of_parts(octree, parts, wanted);
}

Octree components_at_faces(const Octree& octree, Neighbours neighbours) {
  const Parts parts = parts_of(octree, neighbours);
  const int last = parts.runs.side - 1;
  std::vector<bool> wanted(parts.part.size(), false);
  for (int z = 0; z <= last; ++z)
    for (int y = 0; y <= last; ++y)
      for (std::size_t run = parts.runs.begin(y, z); run < parts.runs.end(y, z); ++run)
        if (y == 0 || y == last || z == 0 || z == last || parts.runs.runs[run].first == 0 ||
            parts.runs.runs[run].last == last)
          wanted[parts.part[run]] = true;
  return octree_of_parts(octree, parts, wanted);
}

}  // namespace octotomy::voxel
