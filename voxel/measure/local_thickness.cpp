// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 compute the distance to places outside from voxels' centres and from half-way between them; 2 build a
// pyramid of the largest distances of blocks of 2^3, 4^3 ...; 3 for each sampled voxel, find the largest ball
// that holds the voxel, and skip blocks whose largest distance is no larger than the best so far, or smaller
// than the way to the block; 4 correct each ball's radius by the lattice planes that it touches, and list
// where it touches. Places are counted in steps of the finer lattice, from the lowest corner of the object's
// extent.
#include "voxel/measure/local_thickness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

#include "voxel/measure/distance_map.h"
#include "voxel/space/error.h"
#include "voxel/tree/voxel_boundary.h"

namespace octotomy::voxel {
namespace {

/// A ball must be larger than the largest so far by this factor to be examined.
constexpr double no_larger = 1.0 + 1e-3;
constexpr double coverage_99 = 2.576;  ///< standard errors of a normal distribution

std::size_t count_of(const glm::ivec3& dims) {
  return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
         static_cast<std::size_t>(dims.z);
}
std::size_t index_in(const glm::ivec3& dims, const glm::ivec3& at) {
  return static_cast<std::size_t>(at.x) +
         static_cast<std::size_t>(dims.x) *
             (static_cast<std::size_t>(at.y) +
              static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(at.z));
}

/// For each place, the distance in mm to the nearest place that no voxel of the object touches. The higher
/// levels of the pyramid store the largest distance in each block.
class Pyramid {
 public:
  Pyramid(const Octree& octree, const VoxelRange& range, int finer)
      : finer_(finer), low_(range.low), step_mm_(octree.universe().lattice().spacing_mm() / double(finer)) {
    const glm::ivec3 dims = finer * (range.dims() - 1) + 1;
    DistanceMap map{{glm::ivec3(0), dims - 1}, {}};
    map.square_mm2.assign(count_of(dims), 0.0F);
    // A place counts as outside if no voxel of the object touches it. Places half-way between voxels touch
    // several voxels.
    tbb::parallel_for(0, dims.z, [&](int z) {
      for (int voxel_z = z / finer; voxel_z * finer <= z + finer - 1 && voxel_z < range.dims().z; ++voxel_z)
        for (int y = 0; y < range.dims().y; ++y)
          for (int x = 0; x < range.dims().x; ++x)
            if (octree.contains(low_ + glm::ivec3(x, y, voxel_z)))
              for (int v = std::max(0, finer * y - finer + 1); v < std::min(dims.y, finer * y + finer); ++v)
                for (int u = std::max(0, finer * x - finer + 1); u < std::min(dims.x, finer * x + finer); ++u)
                  map.square_mm2[index_in(dims, {u, v, z})] = std::numeric_limits<float>::infinity();
    });
    Universe stepped = octree.universe();
    for (int axis = 0; axis < 3; ++axis) stepped.lps_from_voxel[axis] /= double(finer);
    spread(map, stepped);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, map.square_mm2.size(), 1 << 16),
                      [&](const auto& part) {
                        for (std::size_t i = part.begin(); i != part.end(); ++i)
                          map.square_mm2[i] = std::sqrt(map.square_mm2[i]);
                      });
    levels_.push_back({dims, std::move(map.square_mm2)});
    while (count_of(levels_.back().dims) > 1) levels_.push_back(halved(levels_.back()));
  }

  int finer() const { return finer_; }
  const glm::dvec3& step_mm() const { return step_mm_; }
  const glm::ivec3& dims() const { return levels_.front().dims; }
  double distance_mm(const glm::ivec3& at) const { return levels_.front().at(at); }
  /// Whether no voxel of the object touches a place.
  bool is_outside(const glm::ivec3& at) const {
    return glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, dims())) ||
           distance_mm(at) == 0.0;
  }
  glm::ivec3 place_of(const glm::ivec3& voxel) const { return finer_ * (voxel - low_); }

  /// The centre of the largest ball that contains a place, if all radii are reduced by `shorter_mm`. Returns
  /// the place itself if no ball is larger.
  glm::ivec3 largest_about(const glm::ivec3& place, double shorter_mm) const {
    Search search{place, shorter_mm, distance_mm(place), place};
    walk(static_cast<int>(levels_.size()) - 1, glm::ivec3(0), search);
    return search.centre;
  }

 private:
  struct Level {
    glm::ivec3 dims{0};
    std::vector<float> largest;
    double at(const glm::ivec3& block) const { return double(largest[index_in(dims, block)]); }
  };
  struct Search {
    glm::ivec3 place;
    double shorter_mm, best_mm;
    glm::ivec3 centre;
  };

  static Level halved(const Level& fine) {
    Level coarse{(fine.dims + 1) / 2, {}};
    coarse.largest.resize(count_of(coarse.dims));
    tbb::parallel_for(0, coarse.dims.z, [&](int z) {
      for (int y = 0; y < coarse.dims.y; ++y)
        for (int x = 0; x < coarse.dims.x; ++x) {
          float largest = 0.0F;
          for (int child = 0; child < 8; ++child) {
            const glm::ivec3 at = 2 * glm::ivec3(x, y, z) + glm::ivec3(child & 1, child >> 1 & 1, child >> 2);
            if (glm::all(glm::lessThan(at, fine.dims)))
              largest = std::max(largest, fine.largest[index_in(fine.dims, at)]);
          }
          coarse.largest[index_in(coarse.dims, {x, y, z})] = largest;
        }
    });
    return coarse;
  }

  void walk(int level, const glm::ivec3& block, Search& search) const {
    const double largest = levels_[static_cast<std::size_t>(level)].at(block);
    if (largest <= search.best_mm * no_larger) return;
    const int side = 1 << level;
    const glm::ivec3 low = side * block, high = low + side - 1;
    const glm::dvec3 apart =
        step_mm_ * glm::dvec3(glm::max(glm::max(low - search.place, search.place - high), glm::ivec3(0)));
    const double reach = largest - search.shorter_mm;
    if (!(reach >= 0.0) || glm::dot(apart, apart) > reach * reach) return;
    if (level == 0) {
      search.best_mm = largest;
      search.centre = block;
      return;
    }
    const Level& finer = levels_[static_cast<std::size_t>(level) - 1];
    std::array<std::pair<double, int>, 8> order{};
    for (int child = 0; child < 8; ++child) {
      const glm::ivec3 at = 2 * block + glm::ivec3(child & 1, child >> 1 & 1, child >> 2);
      order[static_cast<std::size_t>(child)] = {glm::all(glm::lessThan(at, finer.dims)) ? -finer.at(at) : 1.0,
                                                child};
    }
    std::sort(order.begin(), order.end());
    for (const auto& [negated, child] : order)
      if (negated < 0.0)
        walk(level - 1, 2 * block + glm::ivec3(child & 1, child >> 1 & 1, child >> 2), search);
  }

  int finer_;
  glm::ivec3 low_;
  glm::dvec3 step_mm_;
  std::vector<Level> levels_;
};

/// A ball whose centre is a place of the pyramid.
struct LatticeBall {
  double radius_mm = 0.0;
  bool is_of_wall = false;
};

/// Half the distance in mm between the lattice planes across a direction, which is given in steps of places.
/// The surface lies between two such planes. Along an axis it is half a voxel; for oblique directions it
/// approaches 0. If voxels have unequal edges, oblique planes are assumed to be those of cubes with the
/// shortest edge.
double half_planes_mm(const glm::ivec3& direction, const Pyramid& pyramid) {
  const glm::dvec3 voxel_mm = double(pyramid.finer()) * pyramid.step_mm();
  const glm::ivec3 a = glm::abs(direction);
  for (int axis = 0; axis < 3; ++axis)
    if (a[axis] != 0 && a[(axis + 1) % 3] == 0 && a[(axis + 2) % 3] == 0) return 0.5 * voxel_mm[axis];
  const glm::dvec3 primitive = glm::dvec3(a) / double(std::max(1, std::gcd(std::gcd(a.x, a.y), a.z)));
  return 0.5 * std::min({voxel_mm.x, voxel_mm.y, voxel_mm.z}) / glm::length(primitive);
}

/// The largest ball about a centre. Places outside that are up to a voxel farther away than the nearest one
/// also count as touched by the ball: the centre is on a lattice, so it may not be exactly midway between two
/// sides of a wall.
LatticeBall ball_about(const glm::ivec3& centre, const Pyramid& pyramid, double most_cosine) {
  const glm::dvec3& step_mm = pyramid.step_mm();
  const double distance = pyramid.distance_mm(centre);
  const double shell = distance + pyramid.finer() * std::min({step_mm.x, step_mm.y, step_mm.z});
  const double nearest = distance * (1.0 + 1e-6);
  std::vector<glm::dvec3> touching, near;
  double half_planes = std::numeric_limits<double>::infinity();
  const auto add = [&](const glm::ivec3& offset) {
    const glm::dvec3 to_mm = step_mm * glm::dvec3(offset);
    const double length = glm::length(to_mm);
    if (length > shell || length == 0.0 || !pyramid.is_outside(centre + offset)) return;
    near.push_back(to_mm / length);
    if (length > nearest) return;
    touching.push_back(to_mm / length);
    half_planes = std::min(half_planes, half_planes_mm(offset, pyramid));
  };
  const int most_z = static_cast<int>(shell / step_mm.z);
  for (int z = -most_z; z <= most_z; ++z) {
    const double left_z = shell * shell - (step_mm.z * z) * (step_mm.z * z);
    const int most_y = static_cast<int>(std::sqrt(std::max(0.0, left_z)) / step_mm.y);
    for (int y = -most_y; y <= most_y; ++y) {
      const double across = (step_mm.z * z) * (step_mm.z * z) + (step_mm.y * y) * (step_mm.y * y);
      const int high = static_cast<int>(std::sqrt(std::max(0.0, shell * shell - across)) / step_mm.x);
      // No place outside is nearer than `distance`, so in each row the search begins at the sphere of this
      // radius.
      const int low =
          static_cast<int>(std::sqrt(std::max(0.0, distance * distance * (1.0 - 1e-6) - across)) / step_mm.x);
      for (int x = -high; x <= -low; ++x) add({x, y, z});
      for (int x = std::max(low, 1 - low); x <= high; ++x) add({x, y, z});
    }
  }
  LatticeBall ball{distance - (std::isfinite(half_planes) ? half_planes : 0.0)};
  for (std::size_t i = 0; i < std::min<std::size_t>(touching.size(), 8) && !ball.is_of_wall; ++i)
    ball.is_of_wall = std::any_of(near.begin(), near.end(), [&](const glm::dvec3& direction) {
      return glm::dot(direction, touching[i]) <= most_cosine;
    });
  return ball;
}

/// All voxels if there are at most `wanted`, else about `wanted` of them, chosen by a multiplicative hash of
/// their index in the list.
std::vector<glm::ivec3> some_of(const std::vector<glm::ivec3>& voxels, std::size_t wanted) {
  if (voxels.size() <= wanted) return voxels;
  const double share = static_cast<double>(wanted) / static_cast<double>(voxels.size());
  const auto limit = static_cast<std::uint32_t>(share * 0x1p32);
  std::vector<glm::ivec3> some;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (static_cast<std::uint32_t>(i) * 2654435769U < limit) some.push_back(voxels[i]);
  return some;
}

std::vector<glm::ivec3> voxels_of(const Octree& octree, const VoxelRange& range) {
  const glm::ivec3 dims = range.dims();
  std::vector<std::vector<glm::ivec3>> slices(static_cast<std::size_t>(dims.z));
  tbb::parallel_for(0, dims.z, [&](int z) {
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x)
        if (const glm::ivec3 voxel = range.low + glm::ivec3(x, y, z); octree.contains(voxel))
          slices[static_cast<std::size_t>(z)].push_back(voxel);
  });
  std::vector<glm::ivec3> all;
  for (auto& slice : slices) {
    all.insert(all.end(), slice.begin(), slice.end());
    slice = {};
  }
  return all;
}

/// The voxels with at least one face to the outside, each listed once.
std::vector<glm::ivec3> surface_of(const Octree& octree) {
  std::vector<glm::ivec3> voxels;
  for (const VoxelFace& face : voxel_boundary(octree)) voxels.push_back(face.voxel);
  const auto key = [](const glm::ivec3& v) { return std::array{v.z, v.y, v.x}; };
  std::sort(voxels.begin(), voxels.end(),
            [&](const glm::ivec3& a, const glm::ivec3& b) { return key(a) < key(b); });
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

/// Measures the thickness at voxels by one pyramid. Each ball is examined only once, even if it is the
/// largest one of many voxels.
class Balls {
 public:
  Balls(const Pyramid& pyramid, double most_cosine, const Progress& progress)
      : pyramid_(pyramid), most_cosine_(most_cosine), progress_(progress) {}

  std::vector<LatticeBall> about(const std::vector<glm::ivec3>& voxels, double shorter_mm) const {
    const std::vector<Run> runs = runs_about(voxels, shorter_mm);
    std::vector<LatticeBall> balls(voxels.size());
    each(runs.size(), [&](std::size_t r) {
      const LatticeBall ball = ball_about(runs[r].centre, pyramid_, most_cosine_);
      for (const std::size_t i : runs[r].voxels) balls[i] = ball;
    });
    return balls;
  }

  /// The voxel at the thinnest wall, and the largest ball there. Balls are examined in ascending order of
  /// their centres' distances to the outside, in blocks that do not depend on the number of threads. A radius
  /// is at most half a voxel less than the distance, which bounds the search.
  std::optional<std::pair<std::size_t, LatticeBall>> thinnest(const std::vector<glm::ivec3>& voxels) const {
    std::vector<Run> runs = runs_about(voxels, 0.0);
    const auto distance = [&](const Run& run) { return pyramid_.distance_mm(run.centre); };
    std::sort(runs.begin(), runs.end(), [&](const Run& a, const Run& b) {
      return std::pair(distance(a), a.voxels.front()) < std::pair(distance(b), b.voxels.front());
    });
    const glm::dvec3& step_mm = pyramid_.step_mm();
    const double short_mm = 0.5 * pyramid_.finer() * std::max({step_mm.x, step_mm.y, step_mm.z});
    constexpr std::size_t block = 256;
    std::optional<std::pair<std::size_t, LatticeBall>> found;
    for (std::size_t begin = 0; begin < runs.size(); begin += block) {
      if (found && distance(runs[begin]) - short_mm > found->second.radius_mm) break;
      std::vector<LatticeBall> balls(std::min(block, runs.size() - begin));
      each(balls.size(),
           [&](std::size_t k) { balls[k] = ball_about(runs[begin + k].centre, pyramid_, most_cosine_); });
      for (std::size_t k = 0; k < balls.size(); ++k) {
        const std::size_t voxel = runs[begin + k].voxels.front();
        if (balls[k].is_of_wall && (!found || std::pair(balls[k].radius_mm, voxel) <
                                                  std::pair(found->second.radius_mm, found->first)))
          found.emplace(voxel, balls[k]);
      }
    }
    return found;
  }

 private:
  /// Groups the voxels whose largest balls have the same centre, in the voxels' order.
  struct Run {
    glm::ivec3 centre{0};
    std::vector<std::size_t> voxels;
  };

  std::vector<Run> runs_about(const std::vector<glm::ivec3>& voxels, double shorter_mm) const {
    std::vector<glm::ivec3> centres(voxels.size());
    each(voxels.size(), [&](std::size_t i) {
      centres[i] = pyramid_.largest_about(pyramid_.place_of(voxels[i]), shorter_mm);
    });
    std::vector<std::size_t> order(centres.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) { return index_in(pyramid_.dims(), centres[i]); };
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
    std::vector<Run> runs;
    for (const std::size_t i : order) {
      if (runs.empty() || runs.back().centre != centres[i]) runs.push_back({centres[i], {}});
      runs.back().voxels.push_back(i);
    }
    return runs;
  }

  template <typename Do>
  void each(std::size_t count, const Do& task) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16), [&](const auto& part) {
      if (progress_.stop.stop_requested()) return;
      for (std::size_t i = part.begin(); i != part.end(); ++i) task(i);
    });
    if (progress_.stop.stop_requested()) throw Stopped("stopped before the work was done");
  }

  const Pyramid& pyramid_;
  double most_cosine_;
  const Progress& progress_;
};

void summarise(std::vector<double> values, double longest_edge_mm, VoxelThickness& found) {
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value;
  found.mean_mm = sum / count;
  for (const double value : values) squares += (value - found.mean_mm) * (value - found.mean_mm);
  found.deviation_mm = std::sqrt(squares / count);
  found.median_mm = values[values.size() / 2];
  found.largest_mm = values.back();
  found.mean_half_width_mm = 1.25 * longest_edge_mm + coverage_99 * found.deviation_mm / std::sqrt(count);
}

void check(const LocalThicknessOptions& options) {
  if (options.samples < 64) throw InvalidInput("local thickness: the number of samples must be at least 64");
  if (!(options.wall_angle_deg >= 91.0 && options.wall_angle_deg <= 179.0))
    throw InvalidInput("local thickness: a wall's angle must be from 91 to 179 degrees");
}

/// The pyramid of an octree that is not empty.
Pyramid pyramid_of(const Octree& octree) {
  const VoxelRange range = grown(range_of(octree), 1);
  constexpr std::size_t most_fine = std::size_t{1} << 26, most = std::size_t{1} << 28;
  if (count_of(range.dims()) > most)
    throw TooLarge("local thickness: the object's extent has more than 2^28 voxels: choose larger voxels");
  return Pyramid(octree, range, count_of(2 * range.dims()) <= most_fine ? 2 : 1);
}

double most_cosine_of(const LocalThicknessOptions& options) {
  return std::cos(options.wall_angle_deg * std::numbers::pi / 180.0);
}

}  // namespace

VoxelThickness local_thickness(const Octree& octree, const LocalThicknessOptions& options) {
  check(options);
  VoxelThickness found;
  const VoxelRange own = range_of(octree);
  if (own.is_empty()) return found;
  options.progress.at(0.0);
  const Pyramid pyramid = pyramid_of(octree);
  options.progress.at(0.4);
  const Balls balls(pyramid, most_cosine_of(options), options.progress);
  const glm::dvec3 voxel_mm = octree.universe().lattice().spacing_mm();
  // On the way to the nearest place outside, the surface lies 0 to half a voxel before this place.
  const double shorter_mm = 0.25 * std::min({voxel_mm.x, voxel_mm.y, voxel_mm.z});
  std::vector<double> values;
  for (const LatticeBall& ball : balls.about(some_of(voxels_of(octree, own), options.samples), shorter_mm))
    values.push_back(2.0 * ball.radius_mm);
  if (values.empty()) throw std::logic_error("local thickness: no voxel was sampled");
  summarise(std::move(values), std::max({voxel_mm.x, voxel_mm.y, voxel_mm.z}), found);
  options.progress.at(0.7);
  const std::vector<glm::ivec3> surface = some_of(surface_of(octree), options.samples);
  const std::vector<LatticeBall> at_surface = balls.about(surface, 0.0);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    found.surface.push_back({surface[i], 2.0 * at_surface[i].radius_mm, at_surface[i].is_of_wall});
    if (at_surface[i].is_of_wall &&
        (!found.thinnest_wall ||
         found.surface[i].thickness_mm < found.surface[*found.thinnest_wall].thickness_mm))
      found.thinnest_wall = i;
  }
  options.progress.at(1.0);
  return found;
}

std::optional<ThicknessAtVoxel> thinnest_wall(const Octree& octree, const LocalThicknessOptions& options) {
  check(options);
  if (octree.is_empty()) return std::nullopt;
  options.progress.at(0.0);
  const Pyramid pyramid = pyramid_of(octree);
  options.progress.at(0.5);
  const std::vector<glm::ivec3> surface = some_of(surface_of(octree), options.samples);
  const auto thinnest = Balls(pyramid, most_cosine_of(options), options.progress).thinnest(surface);
  options.progress.at(1.0);
  if (!thinnest) return std::nullopt;
  return ThicknessAtVoxel{surface[thinnest->first], 2.0 * thinnest->second.radius_mm, true};
}

}  // namespace octotomy::voxel
