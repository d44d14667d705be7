// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/distance_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "voxel/space/error.h"
#include "voxel/tree/build.h"
#include "voxel/tree/octree_node.h"
#include "voxel/tree/slice_bits.h"

// The axes are processed in turn. Along x, two sweeps compute the distance to the row's nearest voxel; along
// y and z, each line of squares becomes the lower envelope of the parabolas at its entries. Lines are
// independent, so threads share nothing.

namespace octotomy::voxel {
namespace {

constexpr float far_away = std::numeric_limits<float>::infinity();

// Computes the lower envelope of a line's parabolas. Reuses its buffers.
class Envelope {
 public:
  // Replaces line[i] by the minimum over j of line[j] + (step (i - j))^2.
  void lower(std::vector<double>& line, double step) {
    const auto count = static_cast<int>(line.size());
    apex_.assign(line.size(), 0);
    start_.assign(line.size() + 1, 0.0);
    int last = -1;
    const double square_step = step * step;
    for (int i = 0; i < count; ++i) {
      const double here = line[static_cast<std::size_t>(i)];
      if (here == far_away) continue;
      double from = -std::numeric_limits<double>::infinity();
      while (last >= 0) {
        const int j = apex_[static_cast<std::size_t>(last)];
        const double there = line[static_cast<std::size_t>(j)];
        // The position from which on the parabola with its vertex at i is below the parabola with its vertex
        // at j.
        from = 0.5 * ((here - there) / (square_step * (i - j)) + (i + j));
        if (from > start_[static_cast<std::size_t>(last)]) break;
        --last;
        from = -std::numeric_limits<double>::infinity();
      }
      ++last;
      apex_[static_cast<std::size_t>(last)] = i;
      start_[static_cast<std::size_t>(last)] = from;
    }
    if (last < 0) return;
    result_.resize(line.size());
    int at = 0;
    for (int i = 0; i < count; ++i) {
      while (at < last && start_[static_cast<std::size_t>(at) + 1] <= i) ++at;
      const int j = apex_[static_cast<std::size_t>(at)];
      const double away = step * (i - j);
      result_[static_cast<std::size_t>(i)] = line[static_cast<std::size_t>(j)] + away * away;
    }
    line.swap(result_);
  }

 private:
  std::vector<int> apex_;
  std::vector<double> start_;
  std::vector<double> result_;
};

glm::dvec3 orthogonal_spacing_mm(const Universe& universe) {
  const glm::dmat3 edges(universe.lps_from_voxel);
  const glm::dvec3 spacing_mm = universe.lattice().spacing_mm();
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3;
    // A shear below 2^-20 moves the end of the longest universe, 4096 voxels, by less than a hundredth of a
    // voxel.
    if (std::abs(glm::dot(edges[axis], edges[next])) > 0x1p-20 * spacing_mm[axis] * spacing_mm[next])
      throw InvalidInput(
          "distances can be computed only in a universe with axes at right angles: resample the sheared scan "
          "first");
  }
  return spacing_mm;
}

// Sets the entries of slice z to zero for voxels of the set, or of its complement, and to far_away for other
// voxels.
void seed_slice(const Octree& octree, bool complement, int z, DistanceMap& map) {
  const int side = octree.universe().side();
  SliceBits slice;
  const bool outside = z < 0 || z >= side;
  if (!outside) read_slice(octree, z, slice);
  float* out = &map.square_mm2[map.index({map.range.low.x, map.range.low.y, z})];
  for (int y = map.range.low.y; y <= map.range.high.y; ++y) {
    const std::uint64_t* row = outside || y < 0 || y >= side ? nullptr : slice.row(y);
    for (int x = map.range.low.x; x <= map.range.high.x; ++x) {
      const bool inside = row != nullptr && x >= 0 && x < side && ((row[x / 64] >> (x % 64)) & 1) != 0;
      *out++ = inside != complement ? 0.0F : far_away;
    }
  }
}

// Replaces the entries 0 and far_away of a row by squared distances along the row.
void sweep_row(float* row, int count, double step) {
  assert(count > 0 && step > 0.0);
  constexpr int none = std::numeric_limits<int>::max() / 2;
  int away = none;
  for (int x = 0; x < count; ++x) {
    away = row[x] == 0.0F ? 0 : std::min(away + 1, none);
    if (away < none) row[x] = static_cast<float>((step * away) * (step * away));
  }
  away = none;
  for (int x = count - 1; x >= 0; --x) {
    away = row[x] == 0.0F ? 0 : std::min(away + 1, none);
    if (away < none) row[x] = std::min(row[x], static_cast<float>((step * away) * (step * away)));
  }
}

// Replaces each line along `axis` (1 or 2) by the lower envelope of its parabolas.
void sweep_lines(DistanceMap& map, int axis, double step) {
  assert((axis == 1 || axis == 2) && step > 0.0);
  const glm::ivec3 dims = map.range.dims();
  const int other = 3 - axis;
  const std::size_t stride = axis == 1 ? static_cast<std::size_t>(dims.x)
                                       : static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y);
  tbb::parallel_for(tbb::blocked_range<int>(0, dims[other]), [&](const tbb::blocked_range<int>& part) {
    Envelope envelope;
    std::vector<double> line;
    for (int at = part.begin(); at < part.end(); ++at)
      for (int x = 0; x < dims.x; ++x) {
        glm::ivec3 first = map.range.low;
        first.x += x;
        first[other] += at;
        float* start = &map.square_mm2[map.index(first)];
        line.resize(static_cast<std::size_t>(dims[axis]));
        for (std::size_t i = 0; i < line.size(); ++i) line[i] = static_cast<double>(start[i * stride]);
        envelope.lower(line, step);
        for (std::size_t i = 0; i < line.size(); ++i) start[i * stride] = static_cast<float>(line[i]);
      }
  });
}

std::size_t voxels_of(const VoxelRange& range) {
  const glm::ivec3 dims = range.dims();
  return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
         static_cast<std::size_t>(dims.z);
}

DistanceMap cropped(DistanceMap map, const VoxelRange& wanted) {
  if (map.range == wanted) return map;
  DistanceMap part{wanted, {}};
  part.square_mm2.reserve(voxels_of(wanted));
  for (int z = wanted.low.z; z <= wanted.high.z; ++z)
    for (int y = wanted.low.y; y <= wanted.high.y; ++y) {
      const auto row = map.square_mm2.begin() + static_cast<std::ptrdiff_t>(map.index({wanted.low.x, y, z}));
      part.square_mm2.insert(part.square_mm2.end(), row, row + wanted.dims().x);
    }
  return part;
}

DistanceMap map_of(const Octree& octree, bool complement, const VoxelRange& wanted) {
  DistanceMap map{wanted, {}};
  if (wanted.is_empty()) return map;
  // The map must cover every voxel that can be nearest. For the set these lie in the set's range. For the
  // complement a shell of one voxel around this range is added; no voxel farther out is nearer than the
  // shell.
  const VoxelRange set = grown(range_of(octree), 1);
  if (!set.is_empty()) map.range = {glm::min(wanted.low, set.low), glm::max(wanted.high, set.high)};
  map.square_mm2.resize(voxels_of(map.range));
  tbb::parallel_for(map.range.low.z, map.range.high.z + 1,
                    [&](int z) { seed_slice(octree, complement, z, map); });
  spread(map, octree.universe());
  return cropped(std::move(map), wanted);
}

void widen(BlockRef block, int height, const glm::ivec3& origin, VoxelRange& range) {
  const int side = 1 << (2 * height);
  const glm::ivec3 last = origin + side - 1;
  if (block.is_empty() || (!range.is_empty() && glm::all(glm::lessThanEqual(range.low, origin)) &&
                           glm::all(glm::greaterThanEqual(range.high, last))))
    return;
  if (block.is_full()) {
    range = range.is_empty() ? VoxelRange{origin, last}
                             : VoxelRange{glm::min(range.low, origin), glm::max(range.high, last)};
    return;
  }
  for (int child = 0; child < 64; ++child) {
    const glm::ivec3 at = origin + side / 4 * child_place(child);
    if (height > 2) {
      widen(block.child(child), height - 1, at, range);
      continue;
    }
    for (std::uint64_t word = block.word(child); word != 0; word &= word - 1) {
      const int bit = std::countr_zero(word);
      const glm::ivec3 voxel = at + glm::ivec3(bit & 3, (bit >> 2) & 3, bit >> 4);
      range = range.is_empty() ? VoxelRange{voxel, voxel}
                               : VoxelRange{glm::min(range.low, voxel), glm::max(range.high, voxel)};
    }
  }
}

}  // namespace

VoxelRange range_of(const Octree& octree) {
  VoxelRange range;
  widen(octree.root(), octree.root_height(), glm::ivec3(0), range);
  return range;
}

VoxelRange grown(const VoxelRange& range, int voxels) {
  assert(voxels >= 0);
  return range.is_empty() ? range : VoxelRange{range.low - voxels, range.high + voxels};
}

std::size_t DistanceMap::index(const glm::ivec3& voxel) const {
  assert(glm::all(glm::greaterThanEqual(voxel, range.low)) &&
         glm::all(glm::lessThanEqual(voxel, range.high)));
  const glm::ivec3 at = voxel - range.low;
  const glm::ivec3 dims = range.dims();
  return static_cast<std::size_t>(at.x) +
         static_cast<std::size_t>(dims.x) *
             (static_cast<std::size_t>(at.y) +
              static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(at.z));
}

void spread(DistanceMap& map, const Universe& universe) {
  assert(map.range.is_empty() || map.square_mm2.size() == map.index(map.range.high) + 1);
  const glm::dvec3 spacing_mm = orthogonal_spacing_mm(universe);
  const glm::ivec3 dims = map.range.dims();
  tbb::parallel_for(map.range.low.z, map.range.high.z + 1, [&](int z) {
    for (int y = map.range.low.y; y <= map.range.high.y; ++y)
      sweep_row(&map.square_mm2[map.index({map.range.low.x, y, z})], dims.x, spacing_mm.x);
  });
  sweep_lines(map, 1, spacing_mm.y);
  sweep_lines(map, 2, spacing_mm.z);
}

DistanceMap distance_map(const Octree& octree, const VoxelRange& range) {
  return map_of(octree, false, range);
}

DistanceMap distance_map_of_complement(const Octree& octree, const VoxelRange& range) {
  return map_of(octree, true, range);
}

Octree octree_where(const Universe& universe, const DistanceMap& map,
                    const std::function<bool(double square_mm2)>& wanted) {
  return octree_of_blocks(universe, [&](const glm::ivec3& block) -> Block {
    const glm::ivec3 low = glm::max(block * 16, map.range.low);
    const glm::ivec3 high =
        glm::min(glm::min(block * 16 + 15, map.range.high), glm::ivec3(universe.side() - 1));
    if (glm::any(glm::greaterThan(low, high))) return {};
    std::array<std::uint64_t, 64> words{};
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y) {
        const float* row = &map.square_mm2[map.index({low.x, y, z})];
        for (int x = low.x; x <= high.x; ++x)
          if (wanted(static_cast<double>(*row++))) {
            const glm::ivec3 leaf = (glm::ivec3(x, y, z) >> 2) & 3;
            words[static_cast<std::size_t>(child_index(leaf.x, leaf.y, leaf.z))] |=
                std::uint64_t{1} << child_index(x & 3, y & 3, z & 3);
          }
      }
    return make_leaf_block(0, all_children, words.data());
  });
}

std::vector<float> signed_distances_mm(const Octree& octree, const VoxelRange& range) {
  const glm::dvec3 spacing_mm = orthogonal_spacing_mm(octree.universe());
  const double half_mm = 0.5 * std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const DistanceMap to_inside = distance_map(octree, range);
  std::vector<float> distances = distance_map_of_complement(octree, range).square_mm2;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const double outside_mm = std::sqrt(static_cast<double>(to_inside.square_mm2[i]));
    const double inside_mm = std::sqrt(static_cast<double>(distances[i]));
    distances[i] = static_cast<float>(outside_mm > 0.0 ? outside_mm - half_mm : half_mm - inside_mm);
  }
  return distances;
}

}  // namespace octotomy::voxel
