// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Find where the solid's surface crosses the edges between neighbouring voxels' centres, by halving.
// 2 Add the middles of chords and of rings of crossings. They deviate from the surface only by its curvature
//   within a cell, and halve the distance between points.
// 3 Put those points into a k-d tree (Bentley 1975).
// 4 Signed distances change by at most the distance between points. So a block has one value if its middle is
//   farther from the offset surface than from the block's corners. Other blocks are halved down to voxels.
// The octree alone decides on which side of the surface a voxel's centre lies: between two centres that
// differ there is always a crossing, so that sign and distance agree.
#include "voxel/filter/offset.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>
#include <utility>
#include <vector>

#include "voxel/filter/surface_crossings.h"
#include "voxel/measure/distance_map.h"
#include "voxel/space/error.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {
namespace {

/// The largest sample, in steps. Places deeper than this, which is more than ten voxels' diagonals, have this
/// sample.
constexpr double most_steps = 30000.0;

/// Finds the nearest of many points by a k-d tree. A node is a range of the list of points. It is divided at
/// the point in the middle of the range, across the longest side of the points' box.
class NearestPoint {
 public:
  explicit NearestPoint(std::vector<glm::dvec3> points)
      : points_(std::move(points)), axes_(points_.size(), 0) {
    divide(0, points_.size());
  }

  bool empty() const { return points_.empty(); }
  double distance(const glm::dvec3& p) const {
    double square = std::numeric_limits<double>::infinity();
    search(0, points_.size(), p, square);
    return std::sqrt(square);
  }

 private:
  static constexpr std::size_t few = 8, many = 4096;

  void divide(std::size_t begin, std::size_t end) {
    if (end - begin <= few) return;
    glm::dvec3 low = points_[begin], high = low;
    for (std::size_t i = begin; i < end; ++i) {
      low = glm::min(low, points_[i]);
      high = glm::max(high, points_[i]);
    }
    const glm::dvec3 extent = high - low;
    int axis = extent.y > extent.x ? 1 : 0;
    if (extent.z > extent[axis]) axis = 2;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const glm::dvec3& a, const glm::dvec3& b) { return a[axis] < b[axis]; });
    axes_[middle] = static_cast<std::uint8_t>(axis);
    if (end - begin < many) {
      divide(begin, middle);
      divide(middle + 1, end);
    } else {
      tbb::parallel_invoke([=, this] { divide(begin, middle); }, [=, this] { divide(middle + 1, end); });
    }
  }

  void search(std::size_t begin, std::size_t end, const glm::dvec3& p, double& square) const {
    const auto compare = [&](std::size_t i) {
      const glm::dvec3 to = points_[i] - p;
      square = std::min(square, glm::dot(to, to));
    };
    if (end - begin <= few) {
      for (std::size_t i = begin; i < end; ++i) compare(i);
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    const int axis = axes_[middle];
    const double beyond = p[axis] - points_[middle][axis];
    compare(middle);
    search(beyond < 0.0 ? begin : middle + 1, beyond < 0.0 ? middle : end, p, square);
    if (beyond * beyond < square)
      search(beyond < 0.0 ? middle + 1 : begin, beyond < 0.0 ? end : middle, p, square);
  }

  std::vector<glm::dvec3> points_;
  /// For each node the axis across which it is divided, stored at the index of its middle point.
  std::vector<std::uint8_t> axes_;
};

/// The depth of voxels' centres below the offset surface.
class Depths {
 public:
  Depths(const Octree& octree, const Expression& solid, double by_mm)
      : octree_(octree),
        edges_mm_(octree.universe().lps_from_voxel),
        by_mm_(by_mm),
        surface_(on_surface(octree, solid)) {
    for (int corner = 0; corner < 4; ++corner)
      diagonal_mm_ = std::max(diagonal_mm_, glm::length(edges_mm_ * glm::dvec3(1.0, corner & 1 ? 1.0 : -1.0,
                                                                               corner & 2 ? 1.0 : -1.0)));
    step_mm_ = std::exp2(std::floor(std::log2(diagonal_mm_ / 1024.0)));
  }

  double step_mm() const { return step_mm_; }

  /// The depth for all voxels of a block if the offset surface crosses no cell around one of them. This holds
  /// if the depth in the block's middle exceeds its possible change within the block by more than two voxels'
  /// diagonals. Otherwise 0.
  double of_block(const glm::ivec3& first, int side) const {
    const double depth_mm = at(glm::dvec3(first) + 0.5 * (side - 1), first + side / 2);
    return std::abs(depth_mm) > (0.5 * side + 2.0) * diagonal_mm_ ? depth_mm : 0.0;
  }
  double of_voxel(const glm::ivec3& voxel) const { return at(glm::dvec3(voxel), voxel); }

  std::int16_t sample(double depth_mm) const {
    return static_cast<std::int16_t>(std::clamp(std::floor(depth_mm / step_mm_), -most_steps, most_steps));
  }

 private:
  static std::vector<glm::dvec3> on_surface(const Octree& octree, const Expression& solid) {
    std::vector<glm::dvec3> points = SurfaceCrossings(octree, solid).with_middles();
    const glm::dmat3 edges_mm(octree.universe().lps_from_voxel);
    for (glm::dvec3& p : points) p = edges_mm * p;
    return points;
  }

  /// The depth at a position. The position counts as inside the solid exactly if `voxel` is.
  double at(const glm::dvec3& p_voxel, const glm::ivec3& voxel) const {
    const double distance_mm = surface_.distance(edges_mm_ * p_voxel);
    return octree_.contains(voxel) ? by_mm_ + distance_mm : by_mm_ - distance_mm;
  }

  const Octree& octree_;
  glm::dmat3 edges_mm_;
  double by_mm_;
  double diagonal_mm_ = 0.0, step_mm_ = 1.0;
  NearestPoint surface_;
};

/// The blocks of 16 voxels a side that the offset solid may reach.
std::vector<glm::ivec3> blocks_about(const Octree& octree, double by_mm) {
  VoxelRange range = range_of(octree);
  if (range.is_empty()) return {};
  const Universe& universe = octree.universe();
  if (by_mm > 0.0) {
    // Along a voxel axis, the offset spans a number of voxels that depends on the distance between the
    // lattice planes across this axis.
    const glm::dmat3 voxel_from_mm = glm::transpose(glm::inverse(glm::dmat3(universe.lps_from_voxel)));
    glm::ivec3 reach(0);
    for (int axis = 0; axis < 3; ++axis)
      reach[axis] = static_cast<int>(std::min(std::ceil(by_mm * glm::length(voxel_from_mm[axis])) + 2.0,
                                              static_cast<double>(universe.side())));
    range = {range.low - reach, range.high + reach};
  }
  const glm::ivec3 first = glm::max(range.low, glm::ivec3(0)) / 16,
                   last = glm::min(range.high, glm::ivec3(universe.side() - 1)) / 16;
  std::vector<glm::ivec3> blocks;
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) blocks.emplace_back(x, y, z);
  return blocks;
}

void fill(const Depths& depths, const glm::ivec3& block, int side, GreyBrick& brick) {
  for (int leaf = 0; leaf < 64; ++leaf) {
    const glm::ivec3 first = 16 * block + 4 * child_place(leaf);
    auto& samples = brick.samples[static_cast<std::size_t>(leaf)];
    samples.fill(depths.sample(-std::numeric_limits<double>::infinity()));
    if (glm::any(glm::greaterThanEqual(first, glm::ivec3(side)))) continue;
    if (const double depth_mm = side >= 4 ? depths.of_block(first, 4) : 0.0; depth_mm != 0.0) {
      samples.fill(depths.sample(depth_mm));
      continue;
    }
    for (int bit = 0; bit < 64; ++bit) {
      const glm::ivec3 voxel = first + child_place(bit);
      if (glm::all(glm::lessThan(voxel, glm::ivec3(side))))
        samples[static_cast<std::size_t>(bit)] = depths.sample(depths.of_voxel(voxel));
    }
  }
}

/// `region` may be null.
Window offset_in(const Octree& octree, const Expression& solid, double by_mm, const Octree* region,
                 const Progress& progress) {
  if (!std::isfinite(by_mm) || by_mm == 0.0)
    throw InvalidInput("an offset's length must be finite and not 0 mm");
  const Universe& universe = octree.universe();
  const Depths depths(octree, solid, by_mm);
  progress.at(0.4);
  std::vector<glm::ivec3> tried = blocks_about(octree, by_mm);
  if (region != nullptr)
    std::erase_if(tried, [&](const glm::ivec3& block) { return region->leaf_block(block).is_empty(); });
  std::vector<std::uint8_t> is_out(tried.size(), 0);
  tbb::parallel_for(std::size_t{0}, tried.size(), [&](std::size_t i) {
    is_out[i] = universe.side() >= 16 && depths.of_block(16 * tried[i], 16) < 0.0 ? 1 : 0;
  });
  std::vector<glm::ivec3> blocks;
  for (std::size_t i = 0; i < tried.size(); ++i)
    if (is_out[i] == 0) blocks.push_back(tried[i]);
  progress.at(0.5);
  GreyOctree grey = grey_octree_of_bricks(
      universe, static_cast<std::int16_t>(-most_steps), blocks,
      [&](std::size_t number, GreyBrick& brick) {
        if (!progress.stop.stop_requested()) fill(depths, blocks[number], universe.side(), brick);
      },
      Octree::full(universe), depths.step_mm());
  progress.at(1.0);
  return {std::move(grey), 0.0, most_steps};
}

}  // namespace

Window offset(const Octree& octree, const Expression& solid, double by_mm, const Progress& progress) {
  return offset_in(octree, solid, by_mm, nullptr, progress);
}

Window offset_near(const Octree& octree, const Expression& solid, double by_mm, const Octree& region,
                   const Progress& progress) {
  return offset_in(octree, solid, by_mm, &region, progress);
}

}  // namespace octotomy::voxel
