// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/contour/contour.h"

namespace octotomy::brep {

/// Counts the sides of contours that a span crosses in projection. A strip whose spans cross none lies over the
/// area between its rings and cannot cross itself there. In the plane of the contours, in mm.
class SpanClearance {
 public:
  /// The sides of all contours of two sections. Cost: order of the sides.
  SpanClearance(const std::vector<Contour>& lower, const std::vector<Contour>& upper);

  /// The number of sides that a segment crosses between its ends, at most `most`. Sides that it only touches
  /// do not count. Cost: order of the sides near the segment up to the last that is counted.
  int crossed(const glm::dvec2& from_mm, const glm::dvec2& to_mm, int most) const;

 private:
  struct Side {
    glm::dvec2 from, to;
  };
  glm::ivec2 cell_of(const glm::dvec2& p_mm) const;
  std::size_t index(const glm::ivec2& cell) const {
    return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(cells_.x) +
           static_cast<std::size_t>(cell.x);
  }

  std::vector<Side> sides_;
  glm::dvec2 low_{0.0};
  double cell_mm_ = 1.0;
  glm::ivec2 cells_{1};
  std::vector<std::uint32_t> first_;  ///< index in `held_` of each cell's first side, then the end
  std::vector<std::uint32_t> held_;   ///< sides whose boxes touch each cell
};

}  // namespace octotomy::brep
