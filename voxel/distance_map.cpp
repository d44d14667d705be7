// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/distance_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "voxel/build.h"
#include "voxel/slice_bits.h"

// One axis after the other: along x, two sweeps give the distance to the row's nearest voxel; along y and z, each
// line of squares becomes the lower envelope of the parabolas that stand on it. Lines are independent, so that
// threads share nothing.

namespace octotomy::voxel {
namespace {

constexpr float far_away = std::numeric_limits<float>::infinity();

// A line's lower envelope of parabolas; buffers are reused.
class Envelope {
 public:
  // Replaces line[i] by the least of line[j] + (step (i - j))^2.
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
        // Where the parabola on i falls below that on j.
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
    // A shear of 2^-20 moves the end of the longest universe, 4096 voxels, by less than a hundredth of a voxel.
    if (std::abs(glm::dot(edges[axis], edges[next])) > 0x1p-20 * spacing_mm[axis] * spacing_mm[next])
      throw std::invalid_argument(
          "distances need a universe whose axes are at right angles: resample the sheared scan first");
  }
  return spacing_mm;
}

// Square distances along x to the voxels of the set (or of its complement) in slice z.
void sweep_rows(const Octree& octree, bool complement, int z, double step, DistanceMap& map) {
  const int side = octree.universe().side();
  SliceBits slice;
  const bool outside = z < 0 || z >= side;
  if (!outside) read_slice(octree, z, slice);
  const VoxelRange& range = map.range;
  // The nearest voxel of the row may lie beside the range; beyond the universe all voxels are alike.
  const int first = std::min(range.low.x, -1);
  const int last = std::max(range.high.x, side);
  std::vector<int> nearest(static_cast<std::size_t>(last - first + 1));
  constexpr int none = std::numeric_limits<int>::max() / 2;
  for (int y = range.low.y; y <= range.high.y; ++y) {
    const std::uint64_t* row = outside || y < 0 || y >= side ? nullptr : slice.row(y);
    const auto in_set = [&](int x) {
      const bool inside = row != nullptr && x >= 0 && x < side && ((row[x / 64] >> (x % 64)) & 1) != 0;
      return inside != complement;
    };
    int away = none;
    for (int x = first; x <= last; ++x) {
      away = in_set(x) ? 0 : std::min(away + 1, none);
      nearest[static_cast<std::size_t>(x - first)] = away;
    }
    away = none;
    for (int x = last; x >= first; --x) {
      int& here = nearest[static_cast<std::size_t>(x - first)];
      away = std::min(here, std::min(away + 1, none));
      here = away;
    }
    float* out = &map.square_mm2[map.index({range.low.x, y, z})];
    for (int x = range.low.x; x <= range.high.x; ++x) {
      const int steps = nearest[static_cast<std::size_t>(x - first)];
      *out++ = steps >= none ? far_away : static_cast<float>((step * steps) * (step * steps));
    }
  }
}

// Lines along `axis` (1 or 2), each made the lower envelope of its parabolas.
void sweep_lines(DistanceMap& map, int axis, double step) {
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

DistanceMap map_of(const Octree& octree, bool complement, const VoxelRange& wanted) {
  const glm::dvec3 spacing_mm = orthogonal_spacing_mm(octree.universe());
  DistanceMap map{wanted, {}};
  if (wanted.is_empty()) return map;
  // Lines must hold every voxel of the set that could be nearest: the whole set's range, or for the complement
  // a shell of outside voxels around what is asked for, beyond which there are only farther ones.
  const VoxelRange set = complement ? grown(wanted, 1) : range_of(octree);
  if (!set.is_empty()) {
    map.range.low = glm::min(map.range.low, set.low);
    map.range.high = glm::max(map.range.high, set.high);
  }
  if (complement) {
    map.range.low = glm::min(map.range.low, glm::ivec3(-1));
    map.range.high = glm::max(map.range.high, glm::ivec3(octree.universe().side()));
  }
  const glm::ivec3 dims = map.range.dims();
  map.square_mm2.resize(static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
                        static_cast<std::size_t>(dims.z));
  tbb::parallel_for(map.range.low.z, map.range.high.z + 1,
                    [&](int z) { sweep_rows(octree, complement, z, spacing_mm.x, map); });
  sweep_lines(map, 1, spacing_mm.y);
  sweep_lines(map, 2, spacing_mm.z);
  if (map.range.low == wanted.low && map.range.high == wanted.high) return map;
  DistanceMap cropped{wanted, {}};
  const glm::ivec3 kept = wanted.dims();
  cropped.square_mm2.reserve(static_cast<std::size_t>(kept.x) * static_cast<std::size_t>(kept.y) *
                             static_cast<std::size_t>(kept.z));
  for (int z = wanted.low.z; z <= wanted.high.z; ++z)
    for (int y = wanted.low.y; y <= wanted.high.y; ++y) {
      const auto row = map.square_mm2.begin() + static_cast<std::ptrdiff_t>(map.index({wanted.low.x, y, z}));
      cropped.square_mm2.insert(cropped.square_mm2.end(), row, row + kept.x);
    }
  return cropped;
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
    const glm::ivec3 at = origin + side / 4 * glm::ivec3(child & 3, (child >> 2) & 3, child >> 4);
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
  return range.is_empty() ? range : VoxelRange{range.low - voxels, range.high + voxels};
}

std::size_t DistanceMap::index(const glm::ivec3& voxel) const {
  const glm::ivec3 at = voxel - range.low;
  const glm::ivec3 dims = range.dims();
  return static_cast<std::size_t>(at.x) +
         static_cast<std::size_t>(dims.x) *
             (static_cast<std::size_t>(at.y) + static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(at.z));
}

DistanceMap distance_map(const Octree& octree, const VoxelRange& range) {
  return map_of(octree, false, range);
}

DistanceMap distance_map_of_complement(const Octree& octree, const VoxelRange& range) {
  return map_of(octree, true, range);
}

Octree octree_within(const Universe& universe, const DistanceMap& map, double limit_mm2) {
  return octree_of_blocks(universe, [&](const glm::ivec3& block) -> Block {
    const glm::ivec3 low = glm::max(block * 16, map.range.low);
    const glm::ivec3 high = glm::min(glm::min(block * 16 + 15, map.range.high), glm::ivec3(universe.side() - 1));
    if (glm::any(glm::greaterThan(low, high))) return {};
    std::array<std::uint64_t, 64> words{};
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y) {
        const float* row = &map.square_mm2[map.index({low.x, y, z})];
        for (int x = low.x; x <= high.x; ++x)
          if (static_cast<double>(*row++) <= limit_mm2) {
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
