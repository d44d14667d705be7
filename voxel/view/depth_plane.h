// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "voxel/view/depth_image.h"
#include "voxel/view/shade.h"

namespace octotomy::voxel {

/// The depth of background pixels: beyond every universe, and small enough that differences weighted with
/// zero are exactly zero.
inline constexpr float beyond_mm = 1e9f;
inline constexpr float surely_lit_mm = 0.5f * beyond_mm;

/// Two points of the image `distance_mm` apart lie on one surface if their depths differ by at most this
/// value; a larger difference is a break between two surfaces. The limit is reached by a surface at 76
/// degrees to the image plane; steeper surfaces are dark under a light at the observer. Gordon and Reynolds
/// 1985 let the user choose the value; in the thesis's terms (5.2.2.1) it is B = 4.
constexpr double break_mm(double distance_mm) {
  return 4.0 * distance_mm;
}

/// A plane of values with a margin on all sides. Its values are uninitialised.
struct Plane {
  Plane(const glm::ivec2& size, int margin_px)
      : width(size.x + 2 * margin_px),
        margin(margin_px),
        values(std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(width) *
                                                       static_cast<std::size_t>(size.y + 2 * margin_px))) {}
  /// A pointer to pixel 0 of a row. Row numbers and pixel numbers may lie in the margin.
  float* row(int y) { return values.get() + offset(y); }
  const float* row(int y) const { return values.get() + offset(y); }
  std::ptrdiff_t offset(int y) const { return static_cast<std::ptrdiff_t>(y + margin) * width + margin; }

  int width;
  int margin;
  std::unique_ptr<float[]> values;
};

/// The distance in pixels between the two points of which depths are compared: one voxel, but at least one
/// pixel. At a shorter distance, single facets of the interpolation would be visible.
int stride_px(const Scenery& scenery);

/// The smoothed depths of a picture, in a plane whose margin is background, and for each row the extent of
/// the objects.
struct DepthPlane {
  Plane depth;
  /// For each row the first lit pixel and one past the last; equal if none is lit.
  std::vector<glm::ivec2> lit;
  float nearest_mm = beyond_mm;
};

/// Smooths depths over four voxels on each side; depths of voxels' faces are smoothed twice. Each depth
/// changes by at most half a voxel. Only pairs of pixels at equal distance on opposite sides are averaged, so
/// that planes remain planes and every depth remains within its voxel (after Gibson 1998, constrained elastic
/// surface nets). Parallel over rows.
DepthPlane depth_plane(const DepthImage& image, const Scenery& scenery);

}  // namespace octotomy::voxel
