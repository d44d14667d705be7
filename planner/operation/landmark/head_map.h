// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "voxel/view/drawn_object.h"

namespace octotomy::planner {

/// Three orthonormal directions of a head, and the position of its mid-plane. A position in this frame is
/// (left, back, up) in millimetres: left of the mid-plane, back and up from LPS's origin.
struct HeadFrame {
  glm::dvec3 left{1, 0, 0}, back{0, 1, 0}, up{0, 0, 1};
  double mid_mm = 0.0;  ///< position of the mid-plane along `left`, from LPS's origin

  glm::dvec3 lps_mm(const glm::dvec3& place) const {
    return left * (place.x + mid_mm) + back * place.y + up * place.z;
  }
};
/// Makes a head's frame: left is the mid-plane's normal; up is LPS z, made perpendicular to left and rotated
/// about left by pitch_deg. A positive pitch raises the face. Precondition: `normal` is a unit vector, points
/// to the left and is not along z.
HeadFrame head_frame(const glm::dvec3& point_mm, const glm::dvec3& normal, double pitch_deg);

/// A rectangular grid of numbers at equal distances; NaN in cells where no bone was hit. `x` runs along the
/// rows.
class HeadMap {
 public:
  HeadMap(const glm::ivec2& size, const glm::dvec2& first_mm, double step_mm);

  const glm::ivec2& size() const { return size_; }
  double step_mm() const { return step_mm_; }
  double x_mm(int i) const { return first_mm_.x + i * step_mm_; }
  double y_mm(int j) const { return first_mm_.y + j * step_mm_; }
  /// The column and row nearest to a position; they may lie outside of the map.
  int column(double x_mm) const { return static_cast<int>(std::lround((x_mm - first_mm_.x) / step_mm_)); }
  int row(double y_mm) const { return static_cast<int>(std::lround((y_mm - first_mm_.y) / step_mm_)); }
  /// NaN outside.
  double at(int i, int j) const;
  double& set(int i, int j);

 private:
  glm::ivec2 size_;
  glm::dvec2 first_mm_;
  double step_mm_;
  std::vector<double> values_;
};

/// Depth maps of a skull, from the front and from both sides.
struct HeadMaps {
  HeadFrame frame;
  HeadMap front;        ///< over (left, up): the backward coordinate at which bone begins
  HeadMap left, right;  ///< over (back, up): the distance to that side at which bone begins, positive on both
                        ///< sides
};
inline constexpr double head_map_step_mm = 0.5;

/// Draws the three maps with cells of step_mm. Cost: three pictures of the skull by ray casting.
HeadMaps map_head(const voxel::DrawnObject& bone, const HeadFrame& frame, double step_mm = head_map_step_mm);

}  // namespace octotomy::planner
