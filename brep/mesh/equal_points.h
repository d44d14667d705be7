// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Numbers points. Equal points have the same number, in order of first occurrence; 0.0 and -0.0 are equal,
/// NaN equals nothing. Cost: linear; 32 to 40 bytes for each number.
class PointNumbers {
 public:
  /// Appends each new point to `points_mm`. Reserves memory for `expected` points. Preconditions: the list is
  /// empty, outlives this object and is not changed by others.
  explicit PointNumbers(std::vector<glm::dvec3>& points_mm, std::size_t expected = 0);
  std::uint32_t number_of(const glm::dvec3& p_mm);
  /// The numbers of several points, in their order; faster than single calls, because table slots are
  /// prefetched. Precondition: `numbers` has as many entries as `points_mm`.
  void number(std::span<const glm::dvec3> points_mm, std::span<std::uint32_t> numbers);

 private:
  void make_room(std::size_t expected);

  std::vector<glm::dvec3>& points_mm_;
  std::vector<std::uint32_t> table_;  ///< numbers by slot; at most half full
};

/// For each point, the first one with the same coordinates, which may be itself; 0.0 and -0.0 are equal, NaN
/// equals nothing. Cost: linear; 12 to 20 bytes per point.
std::vector<std::uint32_t> first_equal_points(const std::vector<glm::dvec3>& points_mm);

/// 1 for each point at whose position triangles with different labels have a corner, 0 for others. `first` is
/// first_equal_points() of the points; `label` has one number per triangle. Cost: linear.
std::vector<std::uint8_t> shared_points(const Triangles& triangles, const std::vector<std::uint32_t>& first,
                                        const std::vector<std::uint32_t>& label);

}  // namespace octotomy::brep
