// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/radiograph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>
#include <type_traits>

#include "voxel/space/error.h"
#include "voxel/tree/highest_samples.h"
#include "voxel/view/layer.h"
#include "voxel/view/pixel_index.h"

namespace octotomy::voxel {
namespace {

constexpr double water_per_mm = 0.0206;
constexpr double steps_per_voxel = 2.0;
constexpr int leaf_edge = 4;

/// Computes trilinear samples from the bricks that contain a cell's corners. Caches the bricks of the last
/// block and the corners of the last cell, because a ray takes several steps in each.
class CellSamples {
 public:
  explicit CellSamples(const GreyOctree& grey)
      : grey_(grey), last_cell_(grey.universe().side() - 2), last_block_((grey.universe().side() - 1) >> 4) {}

  /// Interpolates along four lines in x, two in y and one in z. The compiler vectorises the steps in x and y.
  double at(const glm::dvec3& p, const glm::ivec3& cell) {
    if (cell.x != cell_.x || cell.y != cell_.y || cell.z != cell_.z) enter(cell);
    const double tx = p.x - cell.x, ty = p.y - cell.y, tz = p.z - cell.z;
    std::array<double, 4> along_x;
    for (std::size_t i = 0; i < 4; ++i) along_x[i] = lower_[i] + (upper_[i] - lower_[i]) * tx;
    std::array<double, 2> along_y;
    for (std::size_t i = 0; i < 2; ++i) along_y[i] = along_x[i] + (along_x[i + 2] - along_x[i]) * ty;
    return along_y[0] + (along_y[1] - along_y[0]) * tz;
  }

 private:
  static constexpr std::size_t offset(int x, int y, int z) {
    const auto part = [](int along, int shift) {
      return static_cast<std::size_t>(((along & 3) << shift) + ((along & 12) << (shift + 4)));
    };
    return part(x, 0) + part(y, 2) + part(z, 4);
  }

  void enter(const glm::ivec3& cell) {
    cell_ = cell;
    // Rounding may lead beyond the universe, where all samples are background.
    if (glm::any(glm::lessThan(cell, glm::ivec3(0))) || glm::any(glm::greaterThan(cell, last_cell_))) {
      for (int line = 0; line < 4; ++line) {
        const glm::ivec3 at = cell + glm::ivec3(0, line >> 1, line & 1);
        lower_[static_cast<std::size_t>(line)] = grey_.sample(at);
        upper_[static_cast<std::size_t>(line)] = grey_.sample(at + glm::ivec3(1, 0, 0));
      }
      return;
    }
    if ((cell >> 4) != block_) enter_block(cell >> 4);
    const glm::ivec3 in = cell & 15;
    const std::size_t x[2] = {offset(in.x, 0, 0), offset((in.x + 1) & 15, 0, 0)};
    const std::size_t y[2] = {offset(0, in.y, 0), offset(0, (in.y + 1) & 15, 0)};
    const std::size_t z[2] = {offset(0, 0, in.z), offset(0, 0, (in.z + 1) & 15)};
    // Bits 0, 1 and 2 are set if the upper corner along x, y and z, respectively, lies in the next brick.
    const std::size_t beyond = static_cast<std::size_t>((in.x + 1) >> 4) |
                               static_cast<std::size_t>(((in.y + 1) >> 4) << 1) |
                               static_cast<std::size_t>(((in.z + 1) >> 4) << 2);
    for (std::size_t line = 0; line < 4; ++line) {
      const std::size_t at = y[line >> 1] + z[line & 1];
      const std::size_t brick = (((line >> 1) << 1) | ((line & 1) << 2)) & beyond;
      lower_[line] = bricks_[brick][at + x[0]];
      upper_[line] = bricks_[brick | (beyond & 1)][at + x[1]];
    }
  }

  void enter_block(const glm::ivec3& block) {
    block_ = block;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 next = block + glm::ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
      bricks_[static_cast<std::size_t>(corner)] =
          grey_.brick(glm::min(next, last_block_)).samples.front().data();
    }
  }

  const GreyOctree& grey_;
  glm::ivec3 last_cell_, last_block_;
  glm::ivec3 cell_{-1000}, block_{-1000};
  std::array<double, 4> lower_{},
      /// Samples at both ends of the cell's edges along x; an edge at (y, z) of the cell has number z + 2y.
      upper_{};
  std::array<const std::int16_t*, 8> bricks_{};  ///< bricks of a block and of the next blocks along each axis
};

/// The positions of a ray's samples: equal steps of at most half a voxel from one end of the ray's span to
/// the other.
struct Steps {
  glm::dvec3 start, per_mm;
  double near_mm;
  int count = 1;
  double length_mm = 0.0;

  Steps(const glm::dvec3& from, const glm::dvec3& along, const DepthSpan& span)
      : start(from), per_mm(along), near_mm(span.near_mm) {
    const double all_mm = span.far_mm - span.near_mm;
    count = std::max(1, static_cast<int>(std::ceil(all_mm * glm::length(per_mm) * steps_per_voxel)));
    length_mm = all_mm / count;
  }

  glm::dvec3 at(int i) const { return start + (near_mm + i * length_mm) * per_mm; }

  /// A step after step i from which a search can continue: at most the first step outside the aligned cube of
  /// `edge` cells a side that contains step i's cell.
  int leaving(int i, const glm::ivec3& cell, int edge) const {
    double exit_mm = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (per_mm[axis] == 0.0) continue;
      const int low = cell[axis] & -edge;
      exit_mm = std::min(exit_mm, ((per_mm[axis] > 0.0 ? low + edge : low) - start[axis]) / per_mm[axis]);
    }
    const double exit = (exit_mm - near_mm) / length_mm;
    return exit >= count ? count + 1 : std::max(i + 1, static_cast<int>(exit));
  }
};

/// The cell in which a position lies: its coordinates rounded down.
inline glm::ivec3 cell_of(const glm::dvec3& p) {
  return {static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)),
          static_cast<int>(std::floor(p.z))};
}

/// Calls take(i, sample) for a ray's steps in their order, except for steps in cubes that have no sample
/// above limit().
template <typename Limit, typename Take>
void march(const GreyOctree& grey, const HighestSamples& highest, const Steps& steps, CellSamples& samples,
           const Limit& limit, const Take& take) {
  const int last = grey.universe().side() - 1;
  for (int i = 0; i <= steps.count;) {
    glm::dvec3 p = steps.at(i);
    glm::ivec3 cell = cell_of(p);
    const glm::ivec3 inside = glm::clamp(cell, 0, last);
    if (const int edge = highest.edge_without(inside, limit()); edge > 0) {
      i = steps.leaving(i, inside, edge);
      continue;
    }
    const int next = steps.leaving(i, inside, leaf_edge);
    const double high = highest.of_leaf(inside);
    while (true) {
      take(i, samples.at(p, cell));
      if (++i >= next || high <= limit()) break;
      p = steps.at(i);
      cell = cell_of(p);
    }
    i = std::max(i, std::min(next, steps.count + 1));
  }
}

/// Calls draw_row(y) for every row, in parallel, until a stop is requested. Throws Stopped.
template <typename DrawRow>
void for_rows(const ImagePlane& plane, const Progress& progress, const DrawRow& draw_row) {
  tbb::parallel_for(0, plane.size_px.y, [&](int y) {
    if (!progress.stop.stop_requested()) draw_row(y);
  });
  progress.at(1.0);
}

/// A table of the attenuation relative to water of every 16-bit sample, multiplied by the weight of the first
/// range that contains the sample.
class WeightedSamples {
 public:
  WeightedSamples(const GreyOctree& grey, const std::vector<RangeWeight>& weights) : of_(65536) {
    for (int sample = -32768; sample < 32768; ++sample) {
      const double value = sample * grey.step();
      const auto range = std::find_if(weights.begin(), weights.end(), [&](const RangeWeight& each) {
        return each.low <= value && value <= each.high;
      });
      of_[static_cast<std::size_t>(sample + 32768)] =
          std::max(0.0, 1.0 + 0.001 * value) * (range != weights.end() ? range->weight : 1.0);
    }
  }
  double operator()(int sample) const { return of_[static_cast<std::size_t>(sample + 32768)]; }

 private:
  std::vector<double> of_;
};

/// Passes samples on unchanged; their attenuation is computed after interpolation.
struct PlainSamples {
  double operator()(int sample) const { return sample; }
};

/// Integrates the attenuation relative to water, which is 0 for air, along rays of one direction. The nodes
/// of the integral are the ends of a ray's span and the points where the ray crosses planes of voxels'
/// centres across `axis`, the axis nearest to the ray's direction.
template <int axis, typename Mapped>
class AttenuationOfRay {
 public:
  AttenuationOfRay(const GreyOctree& grey, const HighestSamples& highest, const Mapped& mapped,
                   const glm::dvec3& per_mm)
      : grey_(grey),
        highest_(highest),
        mapped_(mapped),
        per_mm_(per_mm),
        last_(grey.universe().side() - 1),
        plane_mm_(1.0 / std::abs(per_mm[axis])),
        du_(per_mm[u_axis] / per_mm[axis]),
        dv_(per_mm[v_axis] / per_mm[axis]),
        air_(-1000.0 / grey.step()),
        per_step_(grey.step() * 0.001),
        ends_(grey) {}

  /// In mm of water.
  double operator()(const glm::dvec3& start, const DepthSpan& span) {
    const double near = at_depth(start, span.near_mm), far = at_depth(start, span.far_mm);
    const bool rises = per_mm_[axis] > 0.0;
    const double low_mm = rises ? span.near_mm : span.far_mm, high_mm = rises ? span.far_mm : span.near_mm;
    const int first = static_cast<int>(std::ceil(start[axis] + low_mm * per_mm_[axis]));
    const int last = static_cast<int>(std::floor(start[axis] + high_mm * per_mm_[axis]));
    if (last < first) return 0.5 * (near + far) * (span.far_mm - span.near_mm);
    const Sum planes = of_planes(start, std::max(first, 0), std::min(last, last_));
    // Adds the trapezia between planes, and those from each end of the span to the nearest plane.
    const auto depth_mm = [&](int plane) { return (plane - start[axis]) / per_mm_[axis]; };
    return plane_mm_ * (planes.all - 0.5 * (planes.first + planes.last)) +
           0.5 * std::abs(depth_mm(first) - low_mm) * ((rises ? near : far) + planes.first) +
           0.5 * std::abs(high_mm - depth_mm(last)) * ((rises ? far : near) + planes.last);
  }

 private:
  static constexpr int u_axis = (axis + 1) % 3, v_axis = (axis + 2) % 3;
  struct Sum {
    double all = 0.0, first = 0.0, last = 0.0;
  };

  static constexpr bool is_weighted = std::is_same_v<Mapped, WeightedSamples>;
  /// The attenuation relative to water of an interpolated value of mapped_.
  double relative(double value) const {
    if constexpr (is_weighted) return value;
    return std::max(0.0, 1.0 + value * per_step_);
  }
  double at_depth(const glm::dvec3& start, double depth_mm) {
    const glm::dvec3 p = start + depth_mm * per_mm_;
    if constexpr (is_weighted) return weighted_at(p);
    return relative(ends_.at(p, cell_of(p)));
  }
  double weighted_at(const glm::dvec3& p) const {
    const glm::ivec3 cell = cell_of(p);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 upper(corner & 1, (corner >> 1) & 1, corner >> 2);
      const glm::dvec3 near = 1.0 - glm::abs(p - glm::dvec3(cell + upper));
      sum += near.x * near.y * near.z * mapped_(grey_.sample(cell + upper));
    }
    return sum;
  }

  Sum of_planes(const glm::dvec3& start, int first, int last) {
    Sum sum;
    const double u_at_0 = start[u_axis] - start[axis] * du_, v_at_0 = start[v_axis] - start[axis] * dv_;
    const int last_cell = std::max(0, last_ - 1);
    for (int plane = first; plane <= last;) {
      glm::ivec3 cell;
      cell[axis] = plane;
      cell[u_axis] = std::clamp(static_cast<int>(u_at_0 + plane * du_), 0, last_cell);
      cell[v_axis] = std::clamp(static_cast<int>(v_at_0 + plane * dv_), 0, last_cell);
      const int edge = highest_.edge_without(cell, air_);
      const int end = std::min(last + 1, leaving(plane, cell, edge > 0 ? edge : leaf_edge, u_at_0, v_at_0));
      if (edge == 0) {
        if ((cell >> 4) != block_) enter_block(cell >> 4);
        for (int at = plane; at < end; ++at) {
          const double u = u_at_0 + at * du_, v = v_at_0 + at * dv_;
          const double value = relative(bilinear(at, u, v, cell));
          sum.all += value;
          if (at == first) sum.first = value;
          if (at == last) sum.last = value;
        }
      }
      plane = end;
    }
    return sum;
  }

  /// The sample at a point in a plane; `in` is a cell of the same leaf. A point that lies outside the leaf
  /// because of rounding is assigned to the leaf's border cells.
  double bilinear(int plane, double u, double v, const glm::ivec3& in) const {
    const int low_u = in[u_axis] & ~(leaf_edge - 1), low_v = in[v_axis] & ~(leaf_edge - 1);
    const int cell_u = std::min(std::clamp(static_cast<int>(u), low_u, low_u + leaf_edge - 1), last_ - 1);
    const int cell_v = std::min(std::clamp(static_cast<int>(v), low_v, low_v + leaf_edge - 1), last_ - 1);
    const int in_u = cell_u & 15, in_v = cell_v & 15;
    const std::size_t row = part(plane & 15, axis);
    const std::size_t u0 = part(in_u, u_axis), u1 = part((in_u + 1) & 15, u_axis);
    const std::size_t v0 = row + part(in_v, v_axis), v1 = row + part((in_v + 1) & 15, v_axis);
    const auto next_u = static_cast<std::size_t>((in_u + 1) >> 4);
    const auto next_v = static_cast<std::size_t>((in_v + 1) >> 4 << 1);
    const double a = mapped_(bricks_[0][u0 + v0]), b = mapped_(bricks_[next_u][u1 + v0]);
    const double c = mapped_(bricks_[next_v][u0 + v1]), d = mapped_(bricks_[next_u | next_v][u1 + v1]);
    const double tu = u - cell_u, tv = v - cell_v;
    const double low = a + (b - a) * tu, high = c + (d - c) * tu;
    return low + (high - low) * tv;
  }

  /// The summand of a coordinate within a brick in the number of a sample (grey_octree.h).
  static constexpr std::size_t part(int along, int of_axis) {
    return static_cast<std::size_t>(((along & 3) << (2 * of_axis)) + ((along & 12) << (2 * of_axis + 4)));
  }

  void enter_block(const glm::ivec3& block) {
    block_ = block;
    for (int corner = 0; corner < 4; ++corner) {
      glm::ivec3 next = block;
      next[u_axis] += corner & 1;
      next[v_axis] += corner >> 1;
      bricks_[static_cast<std::size_t>(corner)] =
          grey_.brick(glm::min(next, glm::ivec3(last_ >> 4))).samples.front().data();
    }
  }

  /// The next plane to visit if the ray skips the aligned cube of `edge` cells a side around `cell`: at most
  /// the first plane at which the ray has left the cube, but at least plane + 1.
  int leaving(int plane, const glm::ivec3& cell, int edge, double u_at_0, double v_at_0) const {
    double exit = (cell[axis] & -edge) + edge;
    const auto leave_along = [&](int along, double slope, double at_0) {
      if (slope == 0.0) return;
      const int low = cell[along] & -edge;
      exit = std::min(exit, ((slope > 0.0 ? low + edge : low) - at_0) / slope);
    };
    leave_along(u_axis, du_, u_at_0);
    leave_along(v_axis, dv_, v_at_0);
    return std::max(plane + 1, static_cast<int>(std::min(exit, last_ + 1.0)));
  }

  const GreyOctree& grey_;
  const HighestSamples& highest_;
  const Mapped& mapped_;
  glm::dvec3 per_mm_;
  int last_;
  double plane_mm_;  ///< distance between planes along the ray
  double du_, dv_;   ///< steps across the axis from one plane to the next
  double air_;       ///< sample of air in steps of the samples; exact, because a step is a power of two
  double per_step_;
  CellSamples ends_;
  glm::ivec3 block_{-1000};
  std::array<const std::int16_t*, 4> bricks_{};  ///< bricks of a block and of the next blocks along u and v
};

/// The axis along which a direction has its largest component.
int major_of(const glm::dvec3& per_mm) {
  const glm::dvec3 size = glm::abs(per_mm);
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

template <int axis, typename Mapped>
RayImage radiograph_along(const GreyOctree& grey, const ImagePlane& plane, const VoxelRays& rays,
                          const Mapped& mapped, const Progress& progress) {
  RayImage image{plane.size_px, {}};
  image.values.assign(pixel_count(plane.size_px), 0.0f);
  const HighestSamples highest(grey);
  for_rows(plane, progress, [&](int y) {
    AttenuationOfRay<axis, Mapped> water_mm(grey, highest, mapped, rays.per_mm);
    for (int x = 0; x < plane.size_px.x; ++x) {
      const glm::dvec3 start = rays.start({x + 0.5, y + 0.5});
      if (const auto span = span_among_centres(start, rays.per_mm, grey.universe().side()))
        image.values[pixel_index(plane.size_px, x, y)] =
            static_cast<float>(water_per_mm * water_mm(start, *span));
    }
  });
  return image;
}

template <typename Mapped>
RayImage radiograph_of(const GreyOctree& grey, const ImagePlane& plane, const Mapped& mapped,
                       const Progress& progress) {
  const VoxelRays rays = voxel_rays(grey.universe(), plane);
  switch (major_of(rays.per_mm)) {
    case 0:
      return radiograph_along<0>(grey, plane, rays, mapped, progress);
    case 1:
      return radiograph_along<1>(grey, plane, rays, mapped, progress);
    default:
      return radiograph_along<2>(grey, plane, rays, mapped, progress);
  }
}

}  // namespace

RayImage maximum_intensity(const GreyOctree& grey, const ImagePlane& plane, const Progress& progress) {
  RayImage image{plane.size_px, {}};
  image.values.assign(pixel_count(plane.size_px), static_cast<float>(grey.background() * grey.step()));
  const VoxelRays rays = voxel_rays(grey.universe(), plane);
  const HighestSamples highest(grey);
  for_rows(plane, progress, [&](int y) {
    CellSamples samples(grey);
    double most_at_mm = 0.0;
    for (int x = 0; x < plane.size_px.x; ++x) {
      const glm::dvec3 start = rays.start({x + 0.5, y + 0.5});
      const auto span = span_among_centres(start, rays.per_mm, grey.universe().side());
      if (!span) continue;
      const Steps steps(start, rays.per_mm, *span);
      double most = grey.background();
      const auto take = [&](int i, double sample) {
        if (sample <= most) return;
        most = sample;
        most_at_mm = steps.near_mm + i * steps.length_mm;
      };
      // The maximum often lies at the same depth as that of the last ray. If the cube there is read first,
      // most other cubes cannot raise the maximum.
      const int likely =
          std::clamp(static_cast<int>((most_at_mm - steps.near_mm) / steps.length_mm + 0.5), 0, steps.count);
      const glm::dvec3 p = steps.at(likely);
      take(likely, samples.at(p, cell_of(p)));
      march(
          grey, highest, steps, samples, [&] { return most; }, take);
      image.values[pixel_index(plane.size_px, x, y)] = static_cast<float>(most * grey.step());
    }
  });
  return image;
}

RayImage radiograph(const GreyOctree& grey, const ImagePlane& plane, const Progress& progress,
                    const std::vector<RangeWeight>& weights) {
  check(weights);
  if (weights.empty()) return radiograph_of(grey, plane, PlainSamples{}, progress);
  return radiograph_of(grey, plane, WeightedSamples(grey, weights), progress);
}

void check(const std::vector<RangeWeight>& weights) {
  for (const RangeWeight& range : weights) {
    if (std::isnan(range.low) || std::isnan(range.high) || range.low > range.high)
      throw InvalidInput("a weighted range of samples is empty");
    if (!(range.weight >= 0.0 && range.weight <= RangeWeight::max_weight))
      throw InvalidInput("the weight of a range of samples is not between 0 and 100");
  }
}

std::vector<std::uint8_t> grey_tones(const RayImage& image, double black, double white) {
  std::vector<std::uint8_t> rgb(3 * image.values.size());
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    const double tone = std::clamp((image.values[i] - black) / (white - black), 0.0, 1.0);
    std::fill_n(rgb.begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                static_cast<std::uint8_t>(std::lround(255.0 * tone)));
  }
  return rgb;
}

}  // namespace octotomy::voxel
