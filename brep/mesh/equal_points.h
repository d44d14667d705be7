// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Gives equal points one number, in the order they are met; 0.0 and -0.0 are equal, what is no number equals
/// nothing. Cost: linear; 32 to 40 bytes for each number.
class PointNumbers {
 public:
  /// Appends each new point to a list. `expected` points need no room made on the way. Preconditions: the
  /// list is empty, outlives this and is not changed otherwise.
  explicit PointNumbers(std::vector<glm::dvec3>& points_mm, std::size_t expected = 0);
  std::uint32_t number_of(const glm::dvec3& p_mm);
  /// The same for several points, in their order; faster than one by one, as their places in the table are
  /// fetched ahead. Precondition: as many numbers as points.
  void number(std::span<const glm::dvec3> points_mm, std::span<std::uint32_t> numbers);

 private:
  void make_room(std::size_t expected);

  std::vector<glm::dvec3>& points_mm_;
  std::vector<std::uint32_t> table_;  ///< of numbers by place: at most half full
};

/// For each point the first one that has the same coordinates, itself where it is the first; 0.0 and -0.0 are
/// equal, what is no number equals nothing. Cost: linear; 12 to 20 bytes a point.
std::vector<std::uint32_t> first_equal_points(const std::vector<glm::dvec3>& points_mm);

/// 1 for each point at whose place triangles of more than one label have a corner, 0 for others. `first` is
/// first_equal_points() of the points, `label` one number a triangle. Cost: linear.
std::vector<std::uint8_t> shared_points(const Triangles& triangles, const std::vector<std::uint32_t>& first,
                                        const std::vector<std::uint32_t>& label);

}  // namespace octotomy::brep
