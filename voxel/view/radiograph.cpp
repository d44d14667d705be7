// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/radiograph.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>

#include "voxel/view/layer.h"
#include "voxel/view/pixel_index.h"

namespace octotomy::voxel {
namespace {

constexpr double water_per_mm = 0.0206;
constexpr double steps_per_voxel = 2.0;

double trilinear(const GreyOctree& grey, const glm::dvec3& p) {
  const glm::dvec3 cell = glm::floor(p);
  const glm::dvec3 t = p - cell;
  const glm::ivec3 low(cell);
  const auto along_x = [&](int y, int z) {
    const double at = grey.sample(low + glm::ivec3(0, y, z));
    return at + (grey.sample(low + glm::ivec3(1, y, z)) - at) * t.x;
  };
  const double below = along_x(0, 0) + (along_x(1, 0) - along_x(0, 0)) * t.y;
  const double above = along_x(0, 1) + (along_x(1, 1) - along_x(0, 1)) * t.y;
  return below + (above - below) * t.z;
}

/// The range of the samples in the bricks that a trilinear sample at p depends on.
MinMax range_about(const GreyOctree& grey, const glm::dvec3& p) {
  const int last = grey.universe().side() - 1;
  const glm::ivec3 low = glm::clamp(glm::ivec3(glm::floor(p)), 0, last);
  const glm::ivec3 high = glm::min(low + 1, last);
  MinMax range = grey.range(2, low >> 4);
  if ((low >> 4) != (high >> 4))
    for (int corner = 1; corner < 8; ++corner) {
      const glm::ivec3 at = glm::mix(low, high, glm::bvec3(corner & 1, corner & 2, corner & 4));
      const MinMax& part = grey.range(2, at >> 4);
      range.widen(part);
    }
  return range;
}

/// An image of value(start, per_mm, span) for every ray that meets the universe, and `missing` for the
/// others.
template <typename Value>
RayImage along_rays(const GreyOctree& grey, const ImagePlane& plane, float missing, const Progress& progress,
                    const Value& value) {
  RayImage image{plane.size_px, {}};
  image.values.assign(pixel_count(plane.size_px), missing);
  const VoxelRays rays = voxel_rays(grey.universe(), plane);
  tbb::parallel_for(0, plane.size_px.y, [&](int y) {
    if (progress.stop.stop_requested()) return;
    for (int x = 0; x < plane.size_px.x; ++x) {
      const glm::dvec3 start = rays.start({x + 0.5, y + 0.5});
      if (const auto span = span_among_centres(start, rays.per_mm, grey.universe().side()))
        image.values[pixel_index(plane.size_px, x, y)] = static_cast<float>(value(start, rays.per_mm, *span));
    }
  });
  progress.at(1.0);
  return image;
}

/// The division of a span into equal steps of at most half a voxel.
struct Steps {
  int count = 1;
  double length_mm = 0.0;
};
Steps steps_of(const DepthSpan& span, const glm::dvec3& per_mm) {
  const double length_mm = span.far_mm - span.near_mm;
  const int count =
      std::max(1, static_cast<int>(std::ceil(length_mm * glm::length(per_mm) * steps_per_voxel)));
  return {count, length_mm / count};
}

}  // namespace

RayImage maximum_intensity(const GreyOctree& grey, const ImagePlane& plane, const Progress& progress) {
  const auto missing = static_cast<float>(grey.background() * grey.step());
  return along_rays(grey, plane, missing, progress,
                    [&](const glm::dvec3& start, const glm::dvec3& per_mm, const DepthSpan& span) {
                      const Steps steps = steps_of(span, per_mm);
                      double most = grey.background();
                      for (int i = 0; i <= steps.count; ++i) {
                        const glm::dvec3 p = start + (span.near_mm + i * steps.length_mm) * per_mm;
                        if (range_about(grey, p).high > most) most = std::max(most, trilinear(grey, p));
                      }
                      return most * grey.step();
                    });
}

RayImage radiograph(const GreyOctree& grey, const ImagePlane& plane, const Progress& progress) {
  return along_rays(grey, plane, 0.0f, progress,
                    [&](const glm::dvec3& start, const glm::dvec3& per_mm, const DepthSpan& span) {
                      const Steps steps = steps_of(span, per_mm);
                      double sum = 0.0;
                      for (int i = 0; i <= steps.count; ++i) {
                        const glm::dvec3 p = start + (span.near_mm + i * steps.length_mm) * per_mm;
                        const MinMax range = range_about(grey, p);
                        if (range.high * grey.step() <= -1000.0) continue;
                        const double per_water =
                            std::max(0.0, 1.0 + trilinear(grey, p) * grey.step() / 1000.0);
                        sum += (i == 0 || i == steps.count ? 0.5 : 1.0) * per_water;
                      }
                      return water_per_mm * steps.length_mm * sum;
                    });
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
