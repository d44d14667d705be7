// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "voxel/depth_image.h"
#include "voxel/shade.h"

namespace octotomy::voxel {

/// Depth of pixels that see nothing: beyond every universe, small enough for differences to stay exact zeros
/// when weighted with zero.
inline constexpr float beyond_mm = 1e9f;
inline constexpr float surely_lit_mm = 0.5f * beyond_mm;

/// A plane of values with a margin on all sides.
struct Plane {
  Plane(const glm::ivec2& size, int margin_px, float value)
      : width(size.x + 2 * margin_px),
        margin(margin_px),
        values(static_cast<std::size_t>(width) * static_cast<std::size_t>(size.y + 2 * margin_px), value) {}
  /// Pixel 0 of a row; rows and pixels may reach into the margin.
  float* row(int y) { return values.data() + offset(y); }
  const float* row(int y) const { return values.data() + offset(y); }
  std::ptrdiff_t offset(int y) const { return static_cast<std::ptrdiff_t>(y + margin) * width + margin; }

  int width;
  int margin;
  std::vector<float> values;
};

/// Pixels between the points of a difference: those to a voxel, one at least. Closer, the difference would
/// see single facets of the interpolation.
int stride_px(const Scenery& scenery);

/// Smoothed depths of a picture in a plane whose margin is background, and where there is something to see.
struct DepthPlane {
  Plane depth;
  std::vector<glm::ivec2> lit;  ///< by row: first lit pixel and the one behind the last; equal where none
  float nearest_mm = beyond_mm;
};

/// Depths are smoothed over four voxels on each side, those that are voxels' faces twice, by half a voxel at
/// the most: only ever two pixels at equal distance on opposite sides are averaged, so planes are kept, and
/// so is every depth within the voxel that it was found in (after Gibson 1998, constrained elastic surface
/// nets). Parallel over rows.
DepthPlane depth_plane(const DepthImage& image, const Scenery& scenery);

}  // namespace octotomy::voxel
