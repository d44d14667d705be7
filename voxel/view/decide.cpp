// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/decide.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <tbb/parallel_for.h>
#include <vector>

#include "voxel/space/error.h"
#include "voxel/tree/grey_cell.h"
#include "voxel/view/layer.h"
#include "voxel/view/pixel_index.h"

// For every ray: 1 compute the parts that cuts remove; 2 step through the samples, and skip leaves in which
// no place can meet the criterion; 3 count the stretches on which the criterion holds; 4 halve the step in
// which the wanted stretch begins.

namespace octotomy::voxel {
namespace {

class DecidedRays {
 public:
  DecidedRays(const GreyOctree& grey, const ImagePlane& plane, const Decision& decision,
              std::vector<Cutaway> cuts)
      : grey_(grey),
        plane_(plane),
        decision_(decision),
        cuts_(std::move(cuts)),
        voxel_from_lps_(glm::inverse(grey.universe().lps_from_voxel)),
        lps_from_normal_(glm::transpose(glm::inverse(glm::dmat3(grey.universe().lps_from_voxel)))) {
    const glm::dvec3 spacing = grey.universe().lattice().spacing_mm();
    step_mm_ = 0.5 * std::min({spacing.x, spacing.y, spacing.z});
    const double step = grey.step();
    low_ = decision.low / step;
    high_ = decision.high / step;
    steeper_ = decision.steeper_per_mm / step;
    mark_dull_leaves();
  }

  Seen seen(const glm::dvec2& p_px) const {
    const glm::dvec3 start_mm = plane_.lps_mm(p_px, 0.0);
    const glm::dvec3 along_mm = plane_.lps_mm(p_px, 1.0) - start_mm;
    Ray ray{glm::dvec3(voxel_from_lps_ * glm::dvec4(start_mm, 1.0)),
            glm::dmat3(voxel_from_lps_) * along_mm,
            glm::length(along_mm),
            {}};
    const std::optional<DepthSpan> span = span_among_centres(ray.start, ray.per_mm, grey_.universe().side());
    if (!span) return {};
    for (const Cutaway& cut : cuts_)
      if (const auto part = taken_span(cut, start_mm, along_mm)) ray.taken.push_back(*part);
    return along(ray, *span);
  }

 private:
  struct Ray {
    glm::dvec3 start{0.0};
    glm::dvec3 per_mm{0.0};  ///< the ray's step per millimetre of depth, in voxels
    /// Length of the ray in mm per millimetre of depth; above 1 with an eye at a finite distance.
    double mm_per_depth_mm = 1.0;
    std::vector<TakenSpan> taken;
    glm::dvec3 at(double depth_mm) const { return start + depth_mm * per_mm; }
  };

  Seen along(const Ray& ray, const DepthSpan& span) const {
    const int last = static_cast<int>(std::floor((span.far_mm - span.near_mm) / step_mm_));
    const auto depth_of = [&](int i) { return span.near_mm + i * step_mm_; };
    GreyCell samples(grey_);
    bool before = false;
    int passed = 0;
    for (int i = 0; i <= last;) {
      if (const double until_mm = dull_until_mm(ray, depth_of(i)); until_mm > depth_of(i)) {
        before = false;
        i = std::max(i + 1, static_cast<int>(std::ceil((until_mm - span.near_mm) / step_mm_ - 1e-9)));
        continue;
      }
      const bool now = holds(ray, samples, depth_of(i));
      if (now && !before && passed++ == decision_.peeled)
        return {
            static_cast<float>(i == 0 ? depth_of(0) : begin_mm(ray, samples, depth_of(i - 1), depth_of(i))),
            0, false};
      before = now;
      ++i;
    }
    return {};
  }

  /// The depth between two steps at which the criterion begins to hold.
  double begin_mm(const Ray& ray, GreyCell& samples, double outside_mm, double inside_mm) const {
    constexpr int halvings = 9;
    for (int i = 0; i < halvings; ++i) {
      const double middle_mm = 0.5 * (outside_mm + inside_mm);
      (holds(ray, samples, middle_mm) ? inside_mm : outside_mm) = middle_mm;
    }
    return inside_mm;
  }

  bool holds(const Ray& ray, GreyCell& samples, double depth_mm) const {
    for (const TakenSpan& part : ray.taken)
      if (depth_mm > part.from_mm && depth_mm < part.until_mm) return false;
    const glm::dvec3 p = ray.at(depth_mm);
    switch (decision_.by) {
      case Criterion::Range: {
        const double sample = samples.at(p);
        return sample >= low_ && sample <= high_ && in_scan(p);
      }
      case Criterion::Derivative: {
        const double rise = samples.at(ray.at(depth_mm + step_mm_)) - samples.at(ray.at(depth_mm - step_mm_));
        return rise > 2.0 * step_mm_ * ray.mm_per_depth_mm * steeper_ && deep_in_scan(p);
      }
      case Criterion::Gradient:
        return glm::length(lps_from_normal_ * (0.5 * samples.outward(p))) > steeper_ && deep_in_scan(p);
    }
    return false;
  }

  bool in_scan(const glm::dvec3& p) const { return grey_.scan().contains(glm::ivec3(glm::floor(p + 0.5))); }

  /// Whether all samples on which the change at p depends, those of the cell and of its neighbours, belong to
  /// the scan.
  bool deep_in_scan(const glm::dvec3& p) const {
    const glm::ivec3 cell(glm::floor(p));
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 upper(corner & 1, (corner >> 1) & 1, corner >> 2);
      if (!grey_.scan().contains(cell - 1 + 3 * upper)) return false;
    }
    return true;
  }

  /// If no place of the leaf around the ray can meet the criterion, the depth at which the ray leaves the
  /// leaf; otherwise at most the given depth.
  double dull_until_mm(const Ray& ray, double depth_mm) const {
    const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(ray.at(depth_mm))), 0, 4 * leaves_ - 1);
    if (dull_[leaf_number(cell >> 2)] == 0) return depth_mm;
    double until_mm = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (ray.per_mm[axis] == 0.0) continue;
      const int low = cell[axis] & ~3;
      const double face = ray.per_mm[axis] > 0.0 ? low + 4 : low;
      until_mm = std::min(until_mm, (face - ray.start[axis]) / ray.per_mm[axis]);
    }
    return until_mm;
  }

  std::size_t leaf_number(const glm::ivec3& leaf) const {
    const auto side = static_cast<std::size_t>(leaves_);
    return static_cast<std::size_t>(leaf.x) +
           side * (static_cast<std::size_t>(leaf.y) + side * static_cast<std::size_t>(leaf.z));
  }

  /// Marks leaves by the range of the samples in them and in their 26 neighbours: a change of samples in a
  /// leaf depends on samples at most two voxels away.
  void mark_dull_leaves() {
    leaves_ = std::max(1, grey_.universe().side() / 4);
    const auto side = static_cast<std::size_t>(leaves_);
    dull_.assign(side * side * side, 0);
    tbb::parallel_for(0, leaves_, [&](int z) {
      for (int y = 0; y < leaves_; ++y)
        for (int x = 0; x < leaves_; ++x) {
          MinMax range = range_of_leaf({x, y, z});
          for (int other = 0; other < 27; ++other) {
            const glm::ivec3 near = glm::ivec3(x, y, z) + glm::ivec3(other % 3, other / 3 % 3, other / 9) - 1;
            if (glm::any(glm::lessThan(near, glm::ivec3(0))) ||
                glm::any(glm::greaterThanEqual(near, glm::ivec3(leaves_))))
              continue;
            range.widen(range_of_leaf(near));
          }
          dull_[leaf_number({x, y, z})] = is_dull(range) ? 1 : 0;
        }
    });
  }

  MinMax range_of_leaf(const glm::ivec3& leaf) const {
    const int number = (leaf.x & 3) + 4 * (leaf.y & 3) + 16 * (leaf.z & 3);
    return grey_.brick(leaf >> 2).leaf_range[static_cast<std::size_t>(number)];
  }

  /// Two samples differ by at most the width of their range. The derivative compares two samples two steps
  /// apart. The gradient has three differences, each between samples that are two voxels, so at least four
  /// steps, apart. A change across the universe's border is no surface, so samples beyond the border are
  /// ignored.
  bool is_dull(const MinMax& range) const {
    if (decision_.by == Criterion::Range) return range.high < low_ || range.low > high_;
    const double most = static_cast<double>(range.high) - range.low;
    const double distance_mm =
        decision_.by == Criterion::Derivative ? 2.0 * step_mm_ : 4.0 * step_mm_ / std::sqrt(3.0);
    // The factor adds a margin of a ten-thousandth for rounding.
    return 1.0001 * most < steeper_ * distance_mm;
  }

  const GreyOctree& grey_;
  ImagePlane plane_;
  Decision decision_;
  std::vector<Cutaway> cuts_;
  glm::dmat4 voxel_from_lps_;
  glm::dmat3 lps_from_normal_;
  double step_mm_ = 1.0;
  double low_ = 0.0, high_ = 0.0, steeper_ = 0.0;  ///< bounds of the range, in steps of the samples
  int leaves_ = 1;                                 ///< along an axis
  std::vector<std::uint8_t> dull_;
};

}  // namespace

void check(const Decision& decision) {
  if (decision.peeled < 0) throw InvalidInput("the number of peeled layers must be at least 0");
  if (decision.by == Criterion::Range) {
    if (std::isnan(decision.low) || std::isnan(decision.high) || !(decision.low <= decision.high))
      throw InvalidInput("the range of samples that ends rays is empty: low must be at most high");
  } else if (!(std::isfinite(decision.steeper_per_mm) && decision.steeper_per_mm > 0.0)) {
    throw InvalidInput("the change of samples that ends rays must be positive and finite");
  }
}

Picture decide(const DrawnObject& object, const RenderOptions& options, const Decision& decision) {
  check(decision);
  if (!object.grey || object.moved_from_still)
    throw std::invalid_argument(
        "decision functions along rays need an object with samples that was not moved");
  Picture picture = blank_picture({object}, options);
  picture.algorithm = Algorithm::RayCast;
  picture.visits.reset();
  const ImagePlane plane = plane_of({object}, picture);
  const GreyOctree& grey = *object.grey;
  const DecidedRays rays(grey, plane, decision, options.cuts);
  Layer layer{unlit(plane.size_px), {}, [&rays](const glm::dvec2& p_px, const DepthSpan&) {
                return rays.seen(p_px);
              }};
  tbb::parallel_for(0, plane.size_px.y, [&](int y) {
    for (int x = 0; x < plane.size_px.x; ++x)
      layer.image.pixels[pixel_index(plane.size_px, x, y)] = rays.seen({x + 0.5, y + 0.5});
  });
  std::vector<std::uint8_t> rgb = shade_layer(layer, {object}, plane, options);
  lay_together(std::move(layer.image), std::move(rgb), {}, picture);
  return picture;
}

}  // namespace octotomy::voxel
