// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 spread points over the surface and over the volume, these along lines; 2 find the largest ball that
// touches the surface from inside at each point of the surface, and at the foot of each point of the volume;
// the latter ball holds the volume's point; 3 find the largest of all these balls that holds each point; 4
// repeat step 3 with every fourth ball, to estimate how much the mean rises with more balls.
#include "brep/measure/local_thickness.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/measure/inscribed_balls.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/sample_surface.h"

namespace octotomy::brep {
namespace {

constexpr double search_share = 5e-3;  ///< largest error of a radius, as a share, see
                                       ///< InscribedBalls::touching()
constexpr double coverage_99 = 2.576;  ///< half-width of a 99 % interval, in standard errors of a normal
                                       ///< distribution

double rad(double deg) {
  return deg * std::numbers::pi / 180.0;
}

/// A point of the volume and the volume that it represents.
struct VolumePoint {
  glm::dvec3 p_mm{0.0};
  double volume_mm3 = 0.0;
  std::uint32_t line = 0;
};

/// The x at which a line along x passes the plane of a face.
double x_of(const Triangles& surface, std::uint32_t face, const glm::dvec3& p) {
  const auto& [i, j, k] = surface.faces[face];
  const glm::dvec3 &a = surface.points_mm[i], &b = surface.points_mm[j], &c = surface.points_mm[k];
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double x = a.x - (n.y * (p.y - a.y) + n.z * (p.z - a.z)) / n.x;
  const auto [low, high] = std::minmax({a.x, b.x, c.x});
  return n.x == 0.0 ? 0.5 * (low + high) : std::clamp(x, low, high);
}

/// Points along lines through the solid, about as many as wanted.
std::vector<VolumePoint> volume_points(const Solid& solid, std::size_t wanted) {
  const Size& size = solid.size();
  const glm::dvec3 extent = size.high_mm - size.low_mm;
  const double step = std::cbrt(std::max(size.volume_mm3, 0.0) / static_cast<double>(wanted));
  const double across_mm2 = extent.y * extent.z;
  if (!(step > 0.0) || !(across_mm2 > 0.0)) return {};
  constexpr double most_lines = 1 << 20;
  const auto lines = static_cast<std::uint32_t>(std::clamp(across_mm2 / (step * step), 64.0, most_lines));
  const double line_mm2 = across_mm2 / lines;
  const Triangles& surface = solid.triangles();
  const SurfaceTree& tree = solid.tree();
  std::vector<std::vector<VolumePoint>> parts(lines);
  tbb::parallel_for(std::uint32_t{0}, lines, [&](std::uint32_t line) {
    // Roberts's R3 sequence: multiples of powers of the root of g^4 = g + 1 fill a cube evenly.
    constexpr double g1 = 0.8191725133961645, g2 = 0.6710436067037893, g3 = 0.5497004779019703;
    const auto share = [line](double g) { return std::fmod(0.5 + g * (line + 1.0), 1.0); };
    const glm::dvec3 from(size.low_mm.x - extent.x, size.low_mm.y + share(g1) * extent.y,
                          size.low_mm.z + share(g2) * extent.z);
    std::vector<double> at;
    for (const Crossing& crossing : tree.crossings(from)) at.push_back(x_of(surface, crossing.face, from));
    std::sort(at.begin(), at.end());
    for (std::size_t i = 0; i + 1 < at.size(); i += 2) {
      const double length = at[i + 1] - at[i];
      if (!(length > 0.0)) continue;
      const double count = std::max(1.0, std::round(length / step));
      for (double k = 0.0; k < count; ++k)
        parts[line].push_back(
            {{at[i] + (k + share(g3)) / count * length, from.y, from.z}, line_mm2 * length / count, line});
    }
  });
  std::vector<VolumePoint> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Every n-th sample. Its area includes the areas of the samples that are left out after it.
std::vector<LocalThicknessAt> surface_points(const Solid& solid, std::size_t wanted, double& reach_mm) {
  const auto spacing = std::sqrt(solid.measures().area_mm2 / static_cast<double>(wanted));
  const SurfaceSamples samples = sample_surface(
      solid.triangles(), widened_spacing_mm(solid.triangles(), spacing, 64.0 * static_cast<double>(wanted)));
  const std::size_t every = std::max<std::size_t>(1, samples.points_mm.size() / (2 * wanted));
  reach_mm = samples.reach_mm * std::sqrt(static_cast<double>(every));
  std::vector<LocalThicknessAt> points;
  for (std::size_t i = 0; i < samples.points_mm.size(); ++i) {
    if (i % every == 0) points.push_back({.point = {samples.points_mm[i], samples.normals[i]}});
    points.back().area_mm2 += samples.areas_mm2[i];
  }
  return points;
}

/// The sums from which a mean and its deviation follow.
struct WeightedSums {
  double weight = 0.0, first = 0.0, second = 0.0;
  void add(double value, double w) {
    weight += w;
    first += w * value;
    second += w * value * value;
  }
  double mean() const { return weight > 0.0 ? first / weight : 0.0; }
  double deviation() const {
    return weight > 0.0 ? std::sqrt(std::max(0.0, second / weight - mean() * mean())) : 0.0;
  }
};

double median_of(std::vector<std::pair<double, double>> value_and_weight) {
  std::sort(value_and_weight.begin(), value_and_weight.end());
  double all = 0.0, below = 0.0;
  for (const auto& [value, weight] : value_and_weight) all += weight;
  for (const auto& [value, weight] : value_and_weight)
    if ((below += weight) >= 0.5 * all) return value;
  return 0.0;
}

/// Measures one solid.
class Measurement {
 public:
  Measurement(const Solid& solid, const LocalThicknessOptions& options)
      : solid_(solid),
        options_(options),
        inscribed_(solid.triangles()),
        least_cosine_(std::cos(rad(options.least_angle_deg))) {}

  LocalThickness run() {
    LocalThickness found;
    found.surface = surface_points(solid_, options_.samples, found.reach_mm);
    points_ = volume_points(solid_, options_.samples);
    report(0.1);
    touch(found.surface);
    report(0.4);
    hold();
    report(0.7);
    summarise(found);
    report(1.0);
    return found;
  }

  /// Measures samples in the order of their own balls, the smallest ball first. A sample's thickness is at
  /// least its ball's diameter, so the search ends at the first ball that is larger than the thinnest wall
  /// found. Blocks are fixed, for any number of threads.
  ThinnestWall run_thinnest() {
    ThinnestWall found;
    std::vector<LocalThicknessAt> surface = surface_points(solid_, options_.samples, found.reach_mm);
    report(0.1);
    touch(surface);
    report(0.7);
    std::vector<std::size_t> order(surface.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(balls_[a].radius_mm, a) < std::pair(balls_[b].radius_mm, b);
    });
    const LargestBall all(balls_);
    constexpr std::size_t block = 512;
    std::size_t thinnest = surface.size();
    const auto thickness = [&](std::size_t i) { return std::pair(surface[i].thickness_mm, i); };
    for (std::size_t begin = 0; begin < order.size(); begin += block) {
      if (thinnest < surface.size() && 2.0 * balls_[order[begin]].radius_mm > surface[thinnest].thickness_mm)
        break;
      const std::size_t count = std::min(block, order.size() - begin);
      each(count, [&](std::size_t k) { measure(surface[order[begin + k]], balls_[order[begin + k]], all); });
      for (std::size_t k = begin; k < begin + count; ++k)
        if (surface[order[k]].is_wall &&
            (thinnest == surface.size() || thickness(order[k]) < thickness(thinnest)))
          thinnest = order[k];
    }
    if (thinnest < surface.size()) found.at = surface[thinnest];
    report(1.0);
    return found;
  }

 private:
  template <typename Do>
  void each(std::size_t count, const Do& task) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), [&](const auto& range) {
      if (options_.stop.stop_requested()) return;
      for (std::size_t i = range.begin(); i != range.end(); ++i) task(i);
    });
    if (options_.stop.stop_requested()) throw Stopped("local thickness: stopped");
  }
  void report(double share) const {
    if (options_.stop.stop_requested()) throw Stopped("local thickness: stopped");
    if (options_.progress) options_.progress(share);
  }

  /// The ball is a single point if the ray meets no surface, because the surface is not closed.
  Ball ball_at(const glm::dvec3& p_mm, const glm::dvec3& normal, double ray_mm) const {
    return std::isfinite(ray_mm) ? inscribed_.touching(p_mm, normal, ray_mm, least_cosine_) : Ball{p_mm, 0.0};
  }

  void touch(std::vector<LocalThicknessAt>& surface) {
    balls_.resize(surface.size() + points_.size());
    each(surface.size(), [&](std::size_t i) {
      const auto& [p_mm, normal] = surface[i].point;
      surface[i].ray_mm = inscribed_.ray_mm(p_mm, normal);
      balls_[i] = ball_at(p_mm, normal, surface[i].ray_mm);
    });
    on_surface_ = surface.size();
  }

  /// Finds the balls at the feet of the volume's points.
  void hold() {
    std::vector<glm::dvec3> places;
    for (const VolumePoint& point : points_) places.push_back(point.p_mm);
    const std::vector<Foot> feet = solid_.tree().feet(places);
    each(points_.size(), [&](std::size_t i) {
      const glm::dvec3 outward = feet[i].p_mm - points_[i].p_mm;
      const double distance = glm::length(outward);
      // A point on the surface itself has no direction inward, so its ball is a single point.
      Ball& ball = balls_[on_surface_ + i] = Ball{points_[i].p_mm, 0.0};
      if (!(distance > 0.0)) return;
      const glm::dvec3 normal = outward / distance;
      ball = ball_at(feet[i].p_mm, normal, inscribed_.ray_mm(feet[i].p_mm, normal));
    });
  }

  void measure(LocalThicknessAt& at, const Ball& own, const LargestBall& all) const {
    const Ball ball = all.about(at.point.p_mm, own);
    at.thickness_mm = 2.0 * ball.radius_mm;
    at.is_wall = ball.radius_mm > 0.0 &&
                 inscribed_.touches_opposite(ball, at.point.p_mm, rad(options_.wall_angle_deg));
  }

  void summarise(LocalThickness& found) const {
    const LargestBall all(balls_);
    std::vector<Ball> some;
    // Neighbours in the list are neighbours in space. Therefore a multiplicative hash, and not every n-th
    // place, decides which balls are left out.
    for (std::size_t i = 0; i < balls_.size(); ++i)
      if ((static_cast<std::uint32_t>(i) * 2654435769U) >> 30 == 0) some.push_back(balls_[i]);
    const LargestBall fewer(std::move(some));
    each(on_surface_, [&](std::size_t i) { measure(found.surface[i], balls_[i], all); });
    std::vector<std::pair<double, double>> of_all(points_.size());
    std::vector<double> of_fewer(points_.size());
    each(points_.size(), [&](std::size_t i) {
      const Ball& own = balls_[on_surface_ + i];
      of_all[i] = {2.0 * all.about(points_[i].p_mm, own).radius_mm, points_[i].volume_mm3};
      of_fewer[i] = 2.0 * fewer.about(points_[i].p_mm, own).radius_mm;
    });
    WeightedSums sums, sums_of_fewer;
    std::vector<WeightedSums> groups(16);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto& [value, weight] = of_all[i];
      sums.add(value, weight);
      sums_of_fewer.add(of_fewer[i], weight);
      groups[points_[i].line % groups.size()].add(value, weight);
      found.largest_mm = std::max(found.largest_mm, value);
    }
    for (const LocalThicknessAt& at : found.surface)
      found.largest_mm = std::max(found.largest_mm, at.thickness_mm);
    WeightedSums of_groups;
    for (const WeightedSums& group : groups)
      if (group.weight > 0.0) of_groups.add(group.mean(), 1.0);
    // With four times as many balls, neighbours are half as far apart, and the error is of first order in
    // that distance.
    const double rise = sums.mean() - sums_of_fewer.mean();
    found.mean_mm = std::min(sums.mean() + rise, found.largest_mm);
    found.deviation_mm = sums.deviation();
    found.median_mm = median_of(std::move(of_all));
    found.mean_half_width_mm = 2.0 * rise + search_share * found.mean_mm +
                               coverage_99 * of_groups.deviation() / std::sqrt(of_groups.weight - 1.0);
    for (std::size_t i = 0; i < found.surface.size(); ++i)
      if (found.surface[i].is_wall &&
          (!found.thinnest_wall ||
           found.surface[i].thickness_mm < found.surface[*found.thinnest_wall].thickness_mm))
        found.thinnest_wall = i;
  }

  const Solid& solid_;
  const LocalThicknessOptions& options_;
  InscribedBalls inscribed_;
  double least_cosine_;
  std::vector<VolumePoint> points_;
  std::vector<Ball> balls_;  ///< at the points of the surface, then at the feet of the volume's points
  std::size_t on_surface_ = 0;
};

void check(const Solid& solid, const LocalThicknessOptions& options) {
  if (solid.empty()) throw InvalidInput("local thickness: the solid has no triangles");
  if (!(solid.size().volume_mm3 > 0.0))
    throw InvalidInput("local thickness: the surface faces inward: reverse its triangles");
  if (options.samples < 64) throw InvalidInput("local thickness: needs at least 64 samples");
  if (!(options.least_angle_deg >= 1.0 && options.least_angle_deg <= 120.0))
    throw InvalidInput("local thickness: the least angle of two sheets must be from 1 to 120 degrees");
  if (!(options.wall_angle_deg >= 91.0 && options.wall_angle_deg <= 179.0))
    throw InvalidInput("local thickness: a wall's angle must be from 91 to 179 degrees");
}

}  // namespace

LocalThickness local_thickness(const Solid& solid, const LocalThicknessOptions& options) {
  check(solid, options);
  return Measurement(solid, options).run();
}

ThinnestWall thinnest_wall(const Solid& solid, const LocalThicknessOptions& options) {
  check(solid, options);
  return Measurement(solid, options).run_thinnest();
}

}  // namespace octotomy::brep
