// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/composite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <tbb/parallel_for.h>
#include <tuple>

#include "voxel/space/error.h"
#include "voxel/tree/grey_cell.h"
#include "voxel/view/layer.h"
#include "voxel/view/srgb.h"

// 1 mark the leaves and blocks near visible samples; 2 march every ray: find the next marked leaf, compute
// the samples at the ray's steps in it, light and compose them. The marks do not change the positions of the
// steps.

namespace octotomy::voxel {
namespace {

/// A ray ends when a smaller share than this of the light from behind would be transmitted. Such light
/// changes 8-bit sRGB by less than half a step, even on black.
constexpr float unseen_share = 1.0f / 1024.0f;

/// Marks the cubes of cells that may be visible. A cell lies between the centres of eight voxels.
class VisibleCells {
 public:
  VisibleCells(const GreyOctree& grey, const TransferTable& table) : last_cell_(grey.universe().side() - 1) {
    levels_.push_back(leaves(grey, table));
    while (levels_.back().side > 1) levels_.push_back(coarser(levels_.back()));
  }

  /// The edge, in cells, of the largest invisible cube that contains a cell; 0 if the cell may be visible.
  int invisible_edge(const glm::ivec3& cell) const {
    const glm::ivec3 inside = glm::clamp(cell, 0, last_cell_);
    for (std::size_t level = levels_.size(); level-- > 0;) {
      const int shift = 2 * static_cast<int>(level) + 2;
      if (levels_[level].at(inside >> shift) == 0) return 1 << shift;
    }
    return 0;
  }

 private:
  struct Level {
    int side = 1;
    std::vector<std::uint8_t> visible;
    std::uint8_t at(const glm::ivec3& cube) const { return visible[index(cube)]; }
    std::size_t index(const glm::ivec3& cube) const {
      const auto edge = static_cast<std::size_t>(side);
      return static_cast<std::size_t>(cube.x) +
             edge * (static_cast<std::size_t>(cube.y) + edge * static_cast<std::size_t>(cube.z));
    }
  };

  /// The cells of a leaf extend to the first voxels of the next leaf along each axis.
  static Level leaves(const GreyOctree& grey, const TransferTable& table) {
    const int side = std::max(1, grey.universe().side() / 4);
    const auto count = static_cast<std::size_t>(side);
    std::vector<MinMax> ranges(count * count * count);
    Level level{side, std::vector<std::uint8_t>(ranges.size())};
    tbb::parallel_for(0, side, [&](int z) {
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const GreyBrick& brick = grey.brick(glm::ivec3(x, y, z) >> 2);
          const int leaf = (x & 3) + 4 * (y & 3) + 16 * (z & 3);
          ranges[level.index({x, y, z})] = brick.leaf_range[static_cast<std::size_t>(leaf)];
        }
    });
    tbb::parallel_for(0, side, [&](int z) {
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          MinMax range = ranges[level.index({x, y, z})];
          for (int corner = 1; corner < 8; ++corner) {
            const glm::ivec3 next(x + (corner & 1), y + ((corner >> 1) & 1), z + (corner >> 2));
            if (glm::any(glm::greaterThanEqual(next, glm::ivec3(side)))) continue;
            range.widen(ranges[level.index(next)]);
          }
          level.visible[level.index({x, y, z})] = table.visible(range) ? 1 : 0;
        }
    });
    return level;
  }

  static Level coarser(const Level& fine) {
    const int side = (fine.side + 3) / 4;
    const auto count = static_cast<std::size_t>(side);
    Level level{side, std::vector<std::uint8_t>(count * count * count, 0)};
    for (int z = 0; z < fine.side; ++z)
      for (int y = 0; y < fine.side; ++y)
        for (int x = 0; x < fine.side; ++x)
          level.visible[level.index(glm::ivec3(x, y, z) >> 2)] |= fine.at({x, y, z});
    return level;
  }

  int last_cell_;
  std::vector<Level> levels_;
};

/// A pixel's ray in the universe's index space, as a function of depth.
struct Ray {
  glm::dvec3 start{0.0};
  glm::dvec3 per_mm{0.0};
  glm::dvec3 at(double depth_mm) const { return start + depth_mm * per_mm; }
};

/// The depth at which a ray leaves the aligned cube of `edge` cells a side that contains `cell`.
double leaving_mm(const Ray& ray, double depth_mm, const glm::ivec3& cell, int edge) {
  double least_mm = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.per_mm[axis] == 0.0) continue;
    const int low = cell[axis] & ~(edge - 1);
    const double side = ray.per_mm[axis] > 0.0 ? low + edge : low;
    least_mm = std::min(least_mm, (side - ray.start[axis]) / ray.per_mm[axis]);
  }
  return std::max(least_mm, depth_mm);
}

class March {
 public:
  March(const GreyOctree& grey, const ImagePlane& plane, const CompositeOptions& options)
      : grey_(grey),
        plane_(plane),
        options_(options),
        table_(in_steps(options.transfer, grey), root_range(grey)),
        visible_(grey, table_),
        background_shows_(table_.visible({grey.background(), grey.background()})),
        voxel_from_lps_(glm::inverse(grey.universe().lps_from_voxel)),
        lps_from_normal_(glm::transpose(glm::inverse(glm::dmat3(grey.universe().lps_from_voxel)))) {
    const glm::dvec3 spacing = grey.universe().lattice().spacing_mm();
    step_mm_ = 0.5 * std::min({spacing.x, spacing.y, spacing.z});
    const std::vector<Light> lights = options.lights.empty() ? Scenery{}.lights : options.lights;
    for (const Light& light : lights) {
      const glm::dvec3 towards = glm::normalize(glm::dvec3(light.towards));
      lights_.push_back(
          (plane.view.right * towards.x + plane.view.up * towards.y + plane.view.look * towards.z) *
          static_cast<double>(light.strength));
    }
  }

  /// The light along a pixel's ray, and the depth at which half of the light from behind is lost.
  std::pair<glm::vec4, float> pixel(const glm::dvec2& p_px) const {
    const glm::dvec3 start_mm = plane_.lps_mm(p_px, 0.0);
    const glm::dvec3 along = plane_.lps_mm(p_px, 1.0) - start_mm;
    const Ray ray{glm::dvec3(voxel_from_lps_ * glm::dvec4(start_mm, 1.0)),
                  glm::dmat3(voxel_from_lps_) * along};
    const std::optional<DepthSpan> span = span_among_centres(ray.start, ray.per_mm, grey_.universe().side());
    if (!span) return {glm::vec4(0.0f), nothing};
    std::vector<TakenSpan> taken;
    for (const Cutaway& cut : options_.cuts)
      if (const auto part = taken_span(cut, start_mm, along)) taken.push_back(*part);
    return along_ray(ray, *span, taken);
  }

 private:
  static constexpr float nothing = std::numeric_limits<float>::infinity();

  /// Converts the samples at the transfer function's points to steps of the octree.
  static TransferFunction in_steps(TransferFunction transfer, const GreyOctree& grey) {
    for (TransferPoint& point : transfer.points) point.sample /= grey.step();
    return transfer;
  }

  static MinMax root_range(const GreyOctree& grey) {
    MinMax range = grey.range(std::max(2, root_height(grey.universe().depth)), glm::ivec3(0));
    range.widen({grey.background(), grey.background()});
    return range;
  }

  std::pair<glm::vec4, float> along_ray(const Ray& ray, const DepthSpan& span,
                                        const std::vector<TakenSpan>& taken) const {
    const int steps = static_cast<int>(std::ceil((span.far_mm - span.near_mm) / step_mm_));
    GreyCell samples(grey_);
    glm::vec3 light(0.0f);
    float behind = 1.0f;  // share of the light from behind that is transmitted so far
    float half_mm = nothing;
    for (int i = 0; i < steps && behind >= unseen_share;) {
      const double from_mm = span.near_mm + i * step_mm_;
      const double length_mm = std::min(step_mm_, span.far_mm - from_mm);
      const double depth_mm = from_mm + 0.5 * length_mm;
      const glm::dvec3 p = ray.at(depth_mm);
      const glm::ivec3 cell(glm::floor(p));
      if (const int edge = visible_.invisible_edge(cell); edge > 0) {
        // Continue at the first step whose middle is not in front of the cube's end.
        const double until_mm = leaving_mm(ray, depth_mm, cell, edge);
        i = std::max(i + 1, static_cast<int>(std::ceil((until_mm - span.near_mm) / step_mm_ - 0.5 - 1e-9)));
        continue;
      }
      ++i;
      if (std::any_of(taken.begin(), taken.end(), [&](const TakenSpan& part) {
            return depth_mm > part.from_mm && depth_mm < part.until_mm;
          }))
        continue;
      const TransferTable::Entry entry = table_.at(samples.at(p));
      if (entry.per_mm <= 0.0f || beyond_scan(p)) continue;
      double per_mm = entry.per_mm;
      if (options_.gradient)
        per_mm *= options_.gradient->share(grey_.step() * glm::length(outward(samples, p)));
      if (per_mm <= 0.0) continue;
      const auto through = static_cast<float>(std::exp(-per_mm * length_mm));
      const float share = behind * (1.0f - through);
      light += share * lit(entry.light, samples, p, cut_face(taken, depth_mm));
      behind *= through;
      if (behind <= 0.5f && half_mm == nothing) half_mm = static_cast<float>(depth_mm);
    }
    return {glm::vec4(light, 1.0f - behind), half_mm};
  }

  /// Whether no sample of the scan lies at this position. Evaluated only if the background would be visible.
  bool beyond_scan(const glm::dvec3& p) const {
    return background_shows_ && !grey_.scan().contains(glm::ivec3(glm::floor(p + 0.5)));
  }

  /// The cut whose face lies at most a voxel in front of a depth, so that the face is visible there.
  const TakenSpan* cut_face(const std::vector<TakenSpan>& taken, double depth_mm) const {
    for (const TakenSpan& part : taken)
      if (depth_mm >= part.until_mm && depth_mm < part.until_mm + 2.0 * step_mm_) return &part;
    return nullptr;
  }

  /// The negative gradient in LPS, in steps of the samples per millimetre. It is half the differences over
  /// two voxels, mapped by the inverse transpose of the voxels' axes.
  glm::dvec3 outward(GreyCell& samples, const glm::dvec3& p) const {
    return lps_from_normal_ * (0.5 * samples.outward(p));
  }

  /// The light from a point by Phong's model without gloss. The normal is that of the cut's face, else the
  /// direction of the gradient; without either the point is not shaded.
  glm::vec3 lit(const glm::vec3& light, GreyCell& samples, const glm::dvec3& p, const TakenSpan* cut) const {
    if (cut != nullptr) return light * static_cast<float>(facing(cut->normal));
    const glm::dvec3 falling = outward(samples, p);
    const double slope = glm::length(falling);
    if (!(slope > 0.0)) return light;
    const glm::dvec3 normal = falling / slope;
    const double surface = std::min(1.0, slope / options_.transfer.surface_per_mm * grey_.step());
    const double seen = facing(glm::dot(normal, plane_.view.look) > 0.0 ? -normal : normal);
    return light * static_cast<float>(1.0 + surface * (seen - 1.0));
  }

  /// Light on a surface with a unit normal.
  double facing(const glm::dvec3& normal) const {
    double sum = options_.ambient;
    for (const glm::dvec3& towards : lights_) sum += std::max(0.0, glm::dot(normal, towards));
    return sum;
  }

  const GreyOctree& grey_;
  const ImagePlane& plane_;
  const CompositeOptions& options_;
  TransferTable table_;
  VisibleCells visible_;
  bool background_shows_;
  glm::dmat4 voxel_from_lps_;
  glm::dmat3 lps_from_normal_;
  double step_mm_ = 1.0;
  std::vector<glm::dvec3> lights_;  ///< in LPS; its length is the strength of the gradient
};

}  // namespace

double GradientOpacity::share(double slope_per_mm) const {
  return std::clamp((slope_per_mm - clear_per_mm) / (opaque_per_mm - clear_per_mm), 0.0, 1.0);
}

void check(const GradientOpacity& gradient) {
  if (!(std::isfinite(gradient.opaque_per_mm) && gradient.clear_per_mm >= 0.0 &&
        gradient.opaque_per_mm > gradient.clear_per_mm))
    throw InvalidInput("opacity by gradient needs a low change of at least 0 per mm and a higher high one");
}

Composite composite(const GreyOctree& grey, const ImagePlane& plane, const CompositeOptions& options,
                    const Progress& progress) {
  check(options.transfer);
  if (options.gradient) check(*options.gradient);
  const March march(grey, plane, options);
  const auto width = static_cast<std::size_t>(plane.size_px.x);
  Composite image{plane.size_px, {}, {}};
  image.light.resize(width * static_cast<std::size_t>(plane.size_px.y));
  image.depth_mm.resize(image.light.size());
  tbb::parallel_for(0, plane.size_px.y, [&](int y) {
    if (progress.stop.stop_requested()) return;
    for (int x = 0; x < plane.size_px.x; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
      std::tie(image.light[pixel], image.depth_mm[pixel]) = march.pixel({x + 0.5, y + 0.5});
    }
  });
  progress.at(1.0);
  return image;
}

std::vector<std::uint8_t> over(const Composite& composite, const glm::vec3& background) {
  const glm::vec3 behind = linear_from_srgb(background);
  std::vector<std::uint8_t> rgb(3 * composite.light.size());
  for (std::size_t i = 0; i < composite.light.size(); ++i)
    put_srgb(&rgb[3 * i], glm::vec3(composite.light[i]) + (1.0f - composite.light[i].w) * behind);
  return rgb;
}

}  // namespace octotomy::voxel
