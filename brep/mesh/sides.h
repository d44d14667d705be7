// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Side `corner % 3` of triangle `corner / 3`, from that corner to the next.
struct Side {
  std::uint32_t low, high, corner;  ///< its points, the lower number first
  bool upward;                      ///< runs from the lower point number to the higher
};

constexpr std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}
constexpr std::uint32_t previous_corner(std::uint32_t corner) {
  return corner % 3 == 0 ? corner + 2 : corner - 1;
}

/// All sides, ordered by `low`, `high` and `corner`: those of one edge stand together. Preconditions: every
/// triangle refers to points; 32 bits number three corners of each. Cost: linear where few triangles meet in
/// a point; 16 bytes a side.
std::vector<Side> sorted_sides(const Triangles& triangles);

/// Calls visit(begin, end) with the sides of each edge, in their order.
template <typename Visit>
void each_edge(const std::vector<Side>& sides, const Visit& visit) {
  for (std::size_t i = 0, j; i < sides.size(); i = j) {
    for (j = i + 1; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high;) ++j;
    visit(sides.data() + i, sides.data() + j);
  }
}

}  // namespace octotomy::brep
