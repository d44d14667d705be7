// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/depth_plane.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>

#include "voxel/space/vector_clones.h"

namespace octotomy::voxel {
namespace {

/// The number of taps of the smoothing on each side, a voxel apart. With four taps, a slope with a step every
/// four voxels becomes a plane, and waves that slices four voxels thick cause in interpolated depths are
/// flattened.
constexpr int smoothing_taps = 4;

/// The parameters of one pass of smoothing along x or y: the triangle-weighted mean of pairs of pixels at
/// equal distance on both sides that continue the surface.
struct Smoothing {
  std::ptrdiff_t tap = 1;  ///< distance between taps, in values
  /// Largest difference from the pixel to the first tap; for further taps it grows in proportion.
  float limit_mm = 1.0f;
  float band_mm = 0.5f;  ///< largest change of a depth
};

/// Smooths `count` values of `from` into `to`, within the band around the original depths `found`.
OCTOTOMY_VECTOR_CLONES void smooth_row(const float* __restrict from, const float* __restrict found,
                                       float* __restrict to, int count, const Smoothing& smoothing) {
  const std::ptrdiff_t tap = smoothing.tap;
  const float limit = smoothing.limit_mm;
  const float band = smoothing.band_mm;
  for (int x = 0; x < count; ++x) {
    const float centre = from[x];
    float sum = static_cast<float>(smoothing_taps + 1) * centre;
    float weights = static_cast<float>(smoothing_taps + 1);
    float going_on = 1.0f;
    for (int i = 1; i <= smoothing_taps; ++i) {
      const float one = from[x + i * tap];
      const float other = from[x - i * tap];
      const float reach = limit * static_cast<float>(i);
      const float farther = std::max(std::abs(one - centre), std::abs(other - centre));
      going_on = farther <= reach ? going_on : 0.0f;
      const float weight = going_on * static_cast<float>(smoothing_taps + 1 - i);
      sum += going_on > 0.0f ? weight * (one + other) : 0.0f;
      weights += 2.0f * weight;
    }
    to[x] = std::min(std::max(sum / weights, found[x] - band), found[x] + band);
  }
}

/// The nearest depth of a row, and the part of the row that shows voxels' faces. copy_row() copies a row's
/// depths into the plane and also computes the lit part of the row.
struct RowFacts {
  float nearest_mm = beyond_mm;
  /// The first pixel with a voxel's face and one past the last; no such pixels if equal.
  glm::ivec2 stepped{0};
};
RowFacts copy_row(const DepthImage& image, int y, float* row, glm::ivec2& lit) {
  RowFacts facts;
  lit = glm::ivec2(image.size_px.x, 0);
  for (int x = 0; x < image.size_px.x; ++x) {
    const Seen& seen = image.at(x, y);
    if (!seen.lit()) continue;
    row[x] = seen.depth_mm;
    lit.x = std::min(lit.x, x);
    lit.y = x + 1;
    facts.nearest_mm = std::min(facts.nearest_mm, seen.depth_mm);
    if (seen.stepped) facts.stepped = {facts.stepped.y == 0 ? x : facts.stepped.x, x + 1};
  }
  if (lit.x > lit.y) lit = glm::ivec2(0);
  return facts;
}

}  // namespace

int stride_px(const Scenery& scenery) {
  return std::clamp(static_cast<int>(std::lround(scenery.voxel_mm / scenery.pixel_mm)), 1, 64);
}

DepthPlane depth_plane(const DepthImage& image, const Scenery& scenery) {
  const int step = stride_px(scenery);
  const int margin = smoothing_taps * step;
  const auto rows = static_cast<std::size_t>(image.size_px.y);
  DepthPlane plane{Plane(image.size_px, margin), std::vector<glm::ivec2>(rows)};
  Plane found(image.size_px, margin), between(image.size_px, margin);
  std::vector<RowFacts> facts(rows);
  tbb::parallel_for(-margin, image.size_px.y + margin, [&](int y) {
    float* const row = found.row(y);
    std::fill_n(row - margin, found.width, beyond_mm);
    glm::ivec2 lit(0);
    if (y >= 0 && y < image.size_px.y) {
      const auto number = static_cast<std::size_t>(y);
      facts[number] = copy_row(image, y, row, lit);
      plane.lit[number] = lit;
    }
    // Only pixels outside the lit part are filled, because smoothing writes the lit part.
    for (Plane* const other : {&between, &plane.depth}) {
      std::fill(other->row(y) - margin, other->row(y) + lit.x, beyond_mm);
      std::fill(other->row(y) + lit.y, other->row(y) - margin + other->width, beyond_mm);
    }
  });
  bool any_stepped = false;
  for (const RowFacts& row : facts) {
    plane.nearest_mm = std::min(plane.nearest_mm, row.nearest_mm);
    any_stepped = any_stepped || row.stepped.y > 0;
  }
  Smoothing smoothing;
  smoothing.limit_mm = static_cast<float>(break_mm(step * scenery.pixel_mm) / 2.0);
  smoothing.band_mm = static_cast<float>(0.5 * scenery.voxel_mm);
  for (int pass = 0; pass < (any_stepped ? 4 : 2); ++pass) {
    const bool along_x = pass % 2 == 0;
    const Plane& from = pass == 0 ? found : along_x ? plane.depth : between;
    Plane& to = along_x ? between : plane.depth;
    Smoothing along = smoothing;
    along.tap = along_x ? step : static_cast<std::ptrdiff_t>(step) * found.width;
    tbb::parallel_for(0, image.size_px.y, [&](int y) {
      const auto smooth = [&](const glm::ivec2& x) {
        smooth_row(from.row(y) + x[0], found.row(y) + x[0], to.row(y) + x[0], x[1] - x[0], along);
      };
      const glm::ivec2& lit = plane.lit[static_cast<std::size_t>(y)];
      if (pass < 2) return smooth(lit);
      // Smooths depths of voxels' faces a second time.
      std::copy(from.row(y) + lit.x, from.row(y) + lit.y, to.row(y) + lit.x);
      const glm::ivec2& stepped = facts[static_cast<std::size_t>(y)].stepped;
      smooth(stepped);
      for (int x = stepped.x; x < stepped.y; ++x)
        if (!image.at(x, y).stepped) to.row(y)[x] = from.row(y)[x];
    });
  }
  return plane;
}  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): the caller owns the plane

}  // namespace octotomy::voxel
