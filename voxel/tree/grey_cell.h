// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <limits>

#include "voxel/tree/grey_octree.h"

namespace octotomy::voxel {

/// Computes trilinear samples and differences of a grey octree, in the octree's steps, at positions in
/// voxels. Caches the corners of the last cell, because a ray takes several steps in one cell. Refers to the
/// octree, which must outlive it. To be used by one thread at a time.
class GreyCell {
 public:
  explicit GreyCell(const GreyOctree& grey) : grey_(grey) {}

  double at(const glm::dvec3& p) {
    enter(p);
    return trilinear(corners_, p - glm::dvec3(cell_));
  }

  /// Central differences over two voxels along each axis, interpolated trilinearly between voxels. A
  /// component is positive if samples fall along its axis.
  glm::dvec3 outward(const glm::dvec3& p) {
    enter(p);
    if (!differences_known_) {
      for (std::size_t corner = 0; corner < 8; ++corner) differences_[corner] = difference(corner);
      differences_known_ = true;
    }
    return trilinear(differences_, p - glm::dvec3(cell_));
  }

 private:
  static glm::ivec3 offset(std::size_t corner) {
    return {static_cast<int>(corner & 1), static_cast<int>((corner >> 1) & 1), static_cast<int>(corner >> 2)};
  }

  void enter(const glm::dvec3& p) {
    const glm::ivec3 cell(glm::floor(p));
    if (cell == cell_) return;
    cell_ = cell;
    differences_known_ = false;
    for (std::size_t corner = 0; corner < 8; ++corner) corners_[corner] = grey_.sample(cell + offset(corner));
  }

  /// The difference at a corner. Along every axis one of the corner's two neighbours is another corner of the
  /// cell.
  glm::dvec3 difference(std::size_t corner) const {
    glm::dvec3 falling;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = ((corner >> axis) & 1) != 0;
      glm::ivec3 beyond = cell_ + offset(corner);
      beyond[axis] += upper ? 1 : -1;
      const double inner = corners_[corner ^ (std::size_t{1} << axis)], outer = grey_.sample(beyond);
      falling[axis] = upper ? inner - outer : outer - inner;
    }
    return falling;
  }

  template <typename Value>
  static Value trilinear(const std::array<Value, 8>& corners, const glm::dvec3& t) {
    const auto along_x = [&](std::size_t low) -> Value {
      return corners[low] + (corners[low + 1] - corners[low]) * t.x;
    };
    const Value below = along_x(0) + (along_x(2) - along_x(0)) * t.y;
    const Value above = along_x(4) + (along_x(6) - along_x(4)) * t.y;
    return below + (above - below) * t.z;
  }

  const GreyOctree& grey_;
  glm::ivec3 cell_{std::numeric_limits<int>::min()};
  std::array<double, 8> corners_{};
  std::array<glm::dvec3, 8> differences_{};
  bool differences_known_ = false;
};

}  // namespace octotomy::voxel
