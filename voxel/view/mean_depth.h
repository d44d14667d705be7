// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/view/depth_plane.h"

namespace octotomy::voxel {

/// The mean depth of the lit pixels around a pixel, up to a fortieth of the picture away on each side. Means
/// are computed on a grid of cells of 4 x 4 pixels.
class MeanDepth {
 public:
  MeanDepth(const DepthPlane& plane, const glm::ivec2& size_px);

  /// Stores in `to` the means for the pixels of a row from span.x up to, not including, span.y. Means are
  /// meaningless at pixels far from every lit pixel. Precondition: `to` has the picture's width.
  void mean_row(int y, const glm::ivec2& span, std::vector<float>& to) const;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(x);
  }
  void blur(std::vector<float>& values, int reach) const;

  glm::ivec2 cells_;
  std::vector<float> sums_;              ///< sums of the depths around each cell
  std::vector<float> lit_;               ///< number of lit pixels in each sum
  std::vector<std::uint32_t> low_cell_;  ///< for each x the cell left of the pixel's centre
  std::vector<float> share_;             ///< for each x the weight of the cell right of the pixel's centre
};

}  // namespace octotomy::voxel
