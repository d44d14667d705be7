// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/depth_plane.h"

namespace octotomy::voxel {

/// Mean depth of what is lit about a pixel, a fortieth of the picture on each side, on a grid of cells of 4 x
/// 4 pixels.
class Surroundings {
 public:
  Surroundings(const DepthPlane& plane, const glm::ivec2& size_px);

  /// Means for the pixels of a row from span.x up to span.y; what is far from everything lit is meaningless.
  /// `to` has room for the picture's width.
  void mean_row(int y, const glm::ivec2& span, std::vector<float>& to) const;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(x);
  }
  void blur(std::vector<float>& values, int reach) const;

  glm::ivec2 cells_;
  std::vector<float> sums_;              ///< of depths about a cell
  std::vector<float> lit_;               ///< pixels that these are of
  std::vector<std::uint32_t> low_cell_;  ///< by x: the cell before a pixel's centre
  std::vector<float> share_;             ///< by x: of the cell behind it
};

}  // namespace octotomy::voxel
