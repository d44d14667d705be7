// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Find where the object's surface crosses the edges between voxels' centres, and its triangles.
// 2 In each column along the direction keep the least depth of all triangles.
// 3 The triangles may still cut off sharp edges. At an outline, everything behind a cut-off edge would be
//   lost, so columns just beside an outline search for the object itself at the outline's depths.
// 4 A block has one value if all its columns begin in front of the block, or all behind it. In the other
//   blocks 5^3 points of each voxel are counted: an odd number, so that no share is exactly a half. Whether a
//   voxel belongs to the shadow is decided by its centre, one of these points, so that a tip or a cleft
//   thinner than a voxel is not lost behind the object's voxels.
#include "voxel/filter/shadow.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "voxel/filter/surface_crossings.h"
#include "voxel/solid/membership.h"
#include "voxel/space/error.h"
#include "voxel/tree/octree_node.h"

namespace octotomy::voxel {
namespace {

constexpr int points_an_edge = 5;  ///< number of points along a voxel's edge, and of columns per voxel edge
constexpr int points_a_voxel = points_an_edge * points_an_edge * points_an_edge;
/// Two lengths as shares of a cell's longest edge: how far at most a surface of triangles cuts off an edge of
/// the solid, and how far at most the triangles' middles are moved outward (SurfaceCrossings).
constexpr double cut_off = 0.59, moved_out = 0.75;
/// In voxel edges. An outline is a jump of depth by more than `look_behind`. There the object is searched
/// for from `look_before` in front of the depth to `look_behind` behind it, in steps of `look_step`. At an
/// edge of 90 degrees half a step is lost.
constexpr float look_before = 0.75F, look_behind = 4.0F, look_step = 0.0625F;
/// A range of depths is stored for each square of this number of columns a side.
constexpr int tile_side = 16;
constexpr float no_surface = std::numeric_limits<float>::infinity();

/// A frame with the coordinate z, called depth, along the direction; x and y are perpendicular to it.
struct ColumnFrame {
  glm::dmat3 lps_from_frame{1.0};

  explicit ColumnFrame(const glm::dvec3& direction) {
    const glm::dvec3 beside = std::abs(direction.z) < 0.6 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    const glm::dvec3 across = glm::normalize(glm::cross(beside, direction));
    lps_from_frame = glm::dmat3(across, glm::cross(direction, across), direction);
  }
  glm::dvec3 of(const glm::dvec3& p_mm) const { return glm::transpose(lps_from_frame) * p_mm; }
};

/// For each column the depth of the first surface in it.
class FirstDepths {
 public:
  /// If the direction is parallel to a voxel axis, the columns pass through the points at which voxels'
  /// shares are counted.
  FirstDepths(const Universe& universe, const ColumnFrame& frame, const std::vector<glm::dvec3>& points_voxel)
      : frame_(frame), lattice_(universe.lattice()) {
    const glm::dvec3 spacing_mm = lattice_.spacing_mm();
    pitch_mm_ = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z}) / points_an_edge;
    const double longest = std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z}) / pitch_mm_;
    beside_outline_ = static_cast<int>(std::ceil(cut_off * longest));
    const int margin = static_cast<int>(std::ceil(moved_out * longest));
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const glm::dvec3& p : points_voxel) {
      const glm::dvec3 at = of_voxel(p);
      low = glm::min(low, glm::dvec2(at));
      high = glm::max(high, glm::dvec2(at));
      far_end_mm_ = std::max(far_end_mm_, at.z);
    }
    const glm::dvec2 centre(of_voxel(glm::dvec3(0.0)));
    origin_ = centre + (glm::floor((low - centre) / pitch_mm_) - double(margin)) * pitch_mm_;
    dims_ = glm::ivec2(glm::ceil((high - origin_) / pitch_mm_)) + 1 + margin;
    depths_ = std::vector<std::atomic<float>>(static_cast<std::size_t>(dims_.x) *
                                              static_cast<std::size_t>(dims_.y));
    tbb::parallel_for(std::size_t{0}, depths_.size(),
                      [this](std::size_t i) { depths_[i].store(no_surface, std::memory_order_relaxed); });
  }

  glm::dvec3 of_voxel(const glm::dvec3& p_voxel) const { return frame_.of(lattice_.lps_mm(p_voxel)); }
  double far_end_mm() const { return far_end_mm_; }

  /// Lowers the depths of the columns that pass through a triangle. The triangle's edges are included, so
  /// that neighbouring triangles leave no gap.
  void add(const std::array<glm::dvec3, 3>& corners_voxel) {
    std::array<glm::dvec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = of_voxel(corners_voxel[i]);
      p[i] = {(glm::dvec2(p[i]) - origin_) / pitch_mm_, p[i].z};
    }
    const auto area = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
      return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    const double whole = area(p[0], p[1], p[2]);
    // edge_on is in areas of a column; on_edge is in shares of the triangle and in columns.
    constexpr double edge_on = 1e-12, on_edge = 1e-9;
    if (std::abs(whole) < edge_on) return;
    const glm::dvec2 low = glm::min(glm::min(glm::dvec2(p[0]), glm::dvec2(p[1])), glm::dvec2(p[2])),
                     high = glm::max(glm::max(glm::dvec2(p[0]), glm::dvec2(p[1])), glm::dvec2(p[2]));
    const glm::ivec2 from(glm::ceil(low - on_edge)), to(glm::floor(high + on_edge));
    assert(glm::all(glm::greaterThanEqual(from, glm::ivec2(0))) && glm::all(glm::lessThan(to, dims_)));
    for (int y = from.y; y <= to.y; ++y)
      for (int x = from.x; x <= to.x; ++x) {
        const glm::dvec2 at(x, y);
        const double a = area(p[1], p[2], at) / whole, b = area(p[2], p[0], at) / whole, c = 1.0 - a - b;
        if (a < -on_edge || b < -on_edge || c < -on_edge) continue;
        lower(index({x, y}), static_cast<float>(a * p[0].z + b * p[1].z + c * p[2].z));
      }
  }

  void look_beside_outlines(const Membership& contains) {
    const std::vector<float> nearest = nearest_beside();
    const auto voxel = static_cast<float>(points_an_edge * pitch_mm_);
    tbb::parallel_for(0, dims_.y, [&](int y) {
      for (int x = 0; x < dims_.x; ++x) {
        const std::size_t column = index({x, y});
        const float beside = nearest[column], own = depths_[column].load(std::memory_order_relaxed);
        if (!(own > beside + look_behind * voxel)) continue;
        const glm::dvec2 place = origin_ + glm::dvec2(x, y) * pitch_mm_;
        const auto is_inside = [&](float depth) {
          return contains(frame_.lps_from_frame * glm::dvec3(place, depth));
        };
        float out = beside - look_before * voxel, in = out;
        while (in < beside + look_behind * voxel && !is_inside(in)) {
          out = in;
          in += look_step * voxel;
        }
        if (!is_inside(in)) continue;
        for (int halving = 0; halving < 5; ++halving) {
          const float middle = 0.5F * (out + in);
          (is_inside(middle) ? in : out) = middle;
        }
        lower(column, 0.5F * (out + in));
      }
    });
  }

  /// The volume of all columns from their depths to the object's far end.
  double volume_mm3() const {
    std::vector<double> rows(static_cast<std::size_t>(dims_.y), 0.0);
    tbb::parallel_for(0, dims_.y, [&](int y) {
      for (int x = 0; x < dims_.x; ++x) {
        const float depth = depths_[index({x, y})].load(std::memory_order_relaxed);
        if (depth < no_surface) rows[static_cast<std::size_t>(y)] += far_end_mm_ - double{depth};
      }
    });
    return std::accumulate(rows.begin(), rows.end(), 0.0) * pitch_mm_ * pitch_mm_;
  }

  void sum_up() {
    tiles_ = (dims_ + tile_side - 1) / tile_side;
    ranges_.assign(static_cast<std::size_t>(tiles_.x) * static_cast<std::size_t>(tiles_.y),
                   {no_surface, -no_surface});
    tbb::parallel_for(0, tiles_.y, [this](int row) {
      for (int y = row * tile_side; y < std::min(dims_.y, (row + 1) * tile_side); ++y)
        for (int x = 0; x < dims_.x; ++x) {
          auto& [least, most] = ranges_[static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles_.x) +
                                        static_cast<std::size_t>(x / tile_side)];
          const float depth = depths_[index({x, y})].load(std::memory_order_relaxed);
          least = std::min(least, depth);
          most = std::max(most, depth);
        }
    });
  }

  /// The least and the largest depth of the columns next to a rectangle.
  std::pair<float, float> range(const glm::dvec2& low, const glm::dvec2& high) const {
    const glm::ivec2 from(glm::floor((low - origin_) / pitch_mm_)),
        to(glm::ceil((high - origin_) / pitch_mm_));
    std::pair<float, float> found{no_surface, -no_surface};
    if (from.x < 0 || from.y < 0 || to.x >= dims_.x || to.y >= dims_.y) found.second = no_surface;
    const glm::ivec2 first = glm::max(from, 0) / tile_side, last = glm::min(to, dims_ - 1) / tile_side;
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        const auto& [least, most] = ranges_[static_cast<std::size_t>(y) * static_cast<std::size_t>(tiles_.x) +
                                            static_cast<std::size_t>(x)];
        found = {std::min(found.first, least), std::max(found.second, most)};
      }
    return found;
  }

  /// The depth of the column nearest to a place.
  float at(const glm::dvec2& place) const {
    const glm::ivec2 column(glm::floor((place - origin_) / pitch_mm_ + 0.5));
    if (column.x < 0 || column.y < 0 || column.x >= dims_.x || column.y >= dims_.y) return no_surface;
    return depths_[index(column)].load(std::memory_order_relaxed);
  }

 private:
  std::size_t index(const glm::ivec2& column) const {
    return static_cast<std::size_t>(column.y) * static_cast<std::size_t>(dims_.x) +
           static_cast<std::size_t>(column.x);
  }
  /// For each column the least depth among the column and its neighbours.
  std::vector<float> nearest_beside() const {
    std::vector<float> in_rows(depths_.size()), found(depths_.size());
    tbb::parallel_for(0, dims_.y, [&](int y) {
      for (int x = 0; x < dims_.x; ++x) {
        float least = no_surface;
        const int last = std::min(x + beside_outline_, dims_.x - 1);
        for (int at = std::max(x - beside_outline_, 0); at <= last; ++at)
          least = std::min(least, depths_[index({at, y})].load(std::memory_order_relaxed));
        in_rows[index({x, y})] = least;
      }
    });
    tbb::parallel_for(0, dims_.y, [&](int y) {
      for (int x = 0; x < dims_.x; ++x) {
        float least = no_surface;
        const int last = std::min(y + beside_outline_, dims_.y - 1);
        for (int at = std::max(y - beside_outline_, 0); at <= last; ++at)
          least = std::min(least, in_rows[index({x, at})]);
        found[index({x, y})] = least;
      }
    });
    return found;
  }
  /// The least of several depths does not depend on the order in which threads compare them.
  void lower(std::size_t column, float depth) {
    std::atomic<float>& held = depths_[column];
    float now = held.load(std::memory_order_relaxed);
    while (depth < now && !held.compare_exchange_weak(now, depth, std::memory_order_relaxed)) {
    }
  }

  ColumnFrame frame_;
  Lattice lattice_;
  double pitch_mm_ = 1.0;
  /// Number of columns beside an outline in which the surface may have been cut off.
  int beside_outline_ = 0;
  double far_end_mm_ = -std::numeric_limits<double>::infinity();
  glm::dvec2 origin_{0.0};
  glm::ivec2 dims_{0}, tiles_{0};
  std::vector<std::atomic<float>> depths_;
  std::vector<std::pair<float, float>> ranges_;  ///< of a tile's columns
};

/// Counts the points of voxels that lie in the shadow.
class ShadowShares {
 public:
  ShadowShares(const FirstDepths& depths, double end_mm) : depths_(depths), end_mm_(end_mm) {
    origin_ = depths.of_voxel(glm::dvec3(0.0));
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = 1.0;
      steps_[axis] = depths.of_voxel(step) - origin_;
    }
    std::size_t number = 0;
    for (int z = 0; z < points_an_edge; ++z)
      for (int y = 0; y < points_an_edge; ++y)
        for (int x = 0; x < points_an_edge; ++x)
          points_[number++] = steps_ * ((glm::dvec3(x, y, z) + 0.5) / double{points_an_edge} - 0.5);
  }

  /// The number of a voxel's points in the shadow minus the number outside it, if it is the same for all
  /// voxels of a block; 0 if the difference may vary within the block.
  std::int16_t of_block(const glm::ivec3& first, int side) const {
    const glm::dvec3 middle = origin_ + steps_ * (glm::dvec3(first) + 0.5 * (side - 1));
    const glm::dvec3 reach = 0.5 * side * (glm::abs(steps_[0]) + glm::abs(steps_[1]) + glm::abs(steps_[2]));
    const glm::dvec3 low = middle - reach, high = middle + reach;
    const auto [least, most] = depths_.range(glm::dvec2(low), glm::dvec2(high));
    if (low.z >= most && high.z <= end_mm_) return points_a_voxel;
    return high.z < least || low.z > end_mm_ ? -points_a_voxel : 0;
  }

  std::int16_t of_voxel(const glm::ivec3& voxel) const {
    const glm::dvec3 centre = origin_ + steps_ * glm::dvec3(voxel);
    int share = -points_a_voxel;
    for (const glm::dvec3& point : points_) {
      const glm::dvec3 at = centre + point;
      if (holds(at)) share += 2;
    }
    // A voxel is in the shadow exactly if its centre is, as for the object's voxels. Something thinner than a
    // voxel may contain the centre but less than half of the points; then the sign is changed.
    if (holds(centre) != (share > 0)) share = -share;
    return static_cast<std::int16_t>(share);
  }

 private:
  bool holds(const glm::dvec3& at) const { return at.z >= depths_.at(glm::dvec2(at)) && at.z <= end_mm_; }

  const FirstDepths& depths_;
  double end_mm_;
  glm::dvec3 origin_{0.0};
  glm::dmat3 steps_{1.0};  ///< steps between neighbouring voxels, in the columns' frame
  std::array<glm::dvec3, points_a_voxel> points_;
};

void fill_shares(const ShadowShares& shares, const glm::ivec3& block, int side, GreyBrick& brick) {
  for (int leaf = 0; leaf < 64; ++leaf) {
    const glm::ivec3 first = 16 * block + 4 * child_place(leaf);
    auto& samples = brick.samples[static_cast<std::size_t>(leaf)];
    samples.fill(-points_a_voxel);
    if (glm::any(glm::greaterThanEqual(first, glm::ivec3(side)))) continue;
    if (const std::int16_t share = side >= 4 ? shares.of_block(first, 4) : std::int16_t{0}; share != 0) {
      samples.fill(share);
      continue;
    }
    for (int bit = 0; bit < 64; ++bit) {
      const glm::ivec3 voxel = first + child_place(bit);
      if (glm::all(glm::lessThan(voxel, glm::ivec3(side))))
        samples[static_cast<std::size_t>(bit)] = shares.of_voxel(voxel);
    }
  }
}

void check_unit(const glm::dvec3& direction) {
  // Error in the length of a direction that was normalised or typed with ten digits.
  constexpr double unit_error = 1e-9;
  if (!(std::abs(glm::length(direction) - 1.0) < unit_error))
    throw std::invalid_argument("the direction of a shadow must be a unit vector");
}

void check_voxels(const Octree& octree) {
  if (octree.is_empty()) throw InvalidInput("an object without voxels has no shadow");
}

FirstDepths first_depths(const SurfaceCrossings& crossings, const Universe& universe, const Expression& solid,
                         const glm::dvec3& direction) {
  FirstDepths depths(universe, ColumnFrame(direction), crossings.points());
  crossings.for_triangles([&](const std::array<glm::dvec3, 3>& corners) { depths.add(corners); });
  depths.look_beside_outlines(Membership(universe, solid));
  return depths;
}

}  // namespace

Shadow shadow(const Octree& octree, const Expression& solid, const ShadowOptions& options) {
  check_unit(options.direction);
  if (!std::isfinite(options.end_mm)) throw std::invalid_argument("the end of a shadow must be finite");
  check_voxels(octree);
  const Universe& universe = octree.universe();
  const SurfaceCrossings crossings(octree, solid);
  options.progress.at(0.3);
  FirstDepths depths = first_depths(crossings, universe, solid, options.direction);
  depths.sum_up();
  options.progress.at(0.6);

  const ShadowShares shares(depths, options.end_mm);
  const int side = (universe.side() + 15) / 16;
  std::vector<std::uint8_t> is_in(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) *
                                  static_cast<std::size_t>(side));
  const auto block_of = [side](std::size_t number) {
    const auto n = static_cast<int>(number);
    return glm::ivec3(n % side, n / side % side, n / side / side);
  };
  tbb::parallel_for(std::size_t{0}, is_in.size(),
                    [&](std::size_t i) { is_in[i] = shares.of_block(16 * block_of(i), 16) >= 0 ? 1 : 0; });
  std::vector<glm::ivec3> blocks;
  for (std::size_t i = 0; i < is_in.size(); ++i)
    if (is_in[i] != 0) blocks.push_back(block_of(i));
  options.progress.at(0.7);
  GreyOctree grey = grey_octree_of_bricks(
      universe, static_cast<std::int16_t>(-points_a_voxel), blocks,
      [&](std::size_t number, GreyBrick& brick) {
        if (!options.progress.stop.stop_requested())
          fill_shares(shares, blocks[number], universe.side(), brick);
      },
      Octree::full(universe), 1.0);
  options.progress.at(1.0);
  return {{std::move(grey), 0.0, points_a_voxel}, depths.far_end_mm()};
}

double far_end_mm(const Octree& octree, const Expression& solid, const glm::dvec3& direction) {
  check_voxels(octree);
  check_unit(direction);
  return FirstDepths(octree.universe(), ColumnFrame(direction), SurfaceCrossings(octree, solid).points())
      .far_end_mm();
}

std::vector<double> filled_mm3(const Octree& octree, const Expression& solid,
                               const std::vector<glm::dvec3>& directions, const Progress& progress) {
  check_voxels(octree);
  for (const glm::dvec3& direction : directions) check_unit(direction);
  const Universe& universe = octree.universe();
  const double object_mm3 = static_cast<double>(octree.voxel_count()) * universe.lattice().voxel_mm3();
  const SurfaceCrossings crossings(octree, solid);
  std::vector<double> found;
  for (const glm::dvec3& direction : directions) {
    progress.at(static_cast<double>(found.size()) / static_cast<double>(directions.size()));
    found.push_back(first_depths(crossings, universe, solid, direction).volume_mm3() - object_mm3);
  }
  return found;
}

}  // namespace octotomy::voxel
