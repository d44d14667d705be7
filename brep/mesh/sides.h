// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
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

/// The sides of triangles by the lower of their points. Preconditions: every triangle refers to points; 32
/// bits number three corners of each. Cost: linear; 4 bytes a side and 4 a point.
class SidesOfPoints {
 public:
  explicit SidesOfPoints(const Triangles& triangles);

  std::size_t point_count() const { return end_.size(); }
  std::size_t first(std::size_t point) const { return point == 0 ? 0 : end_[point - 1]; }
  std::size_t end(std::size_t point) const { return end_[point]; }
  /// Writes the sides of a point, ordered by `high` and `corner`.
  void put(std::size_t point, Side* sides) const;

 private:
  const Triangles& triangles_;
  std::vector<std::uint32_t> end_;      ///< by point, where its sides end among the corners
  std::vector<std::uint32_t> corners_;  ///< that the sides leave
};

/// Calls visit(begin, end) with the sides of each edge, in their order.
template <typename Visit>
void each_edge(const Side* sides, std::size_t count, const Visit& visit) {
  for (std::size_t i = 0, j; i < count; i = j) {
    for (j = i + 1; j < count && sides[j].low == sides[i].low && sides[j].high == sides[i].high;) ++j;
    visit(sides + i, sides + j);
  }
}
template <typename Visit>
void each_edge(const std::vector<Side>& sides, const Visit& visit) {
  each_edge(sides.data(), sides.size(), visit);
}

/// The same from several threads, the edges in no order; those of one edge are ordered by `corner`.
/// Preconditions as SidesOfPoints.
template <typename Visit>
void each_edge_in_parallel(const Triangles& triangles, const Visit& visit) {
  const SidesOfPoints sides(triangles);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sides.point_count(), 4096), [&](const auto& range) {
    std::vector<Side> of_point;
    for (std::size_t point = range.begin(); point != range.end(); ++point) {
      of_point.resize(sides.end(point) - sides.first(point));
      sides.put(point, of_point.data());
      each_edge(of_point, visit);
    }
  });
}

/// Calls begin(corner) for the first corner of each fan, the triangles about a point that are joined by
/// sides, in ascending order, and place(corner) for each corner of it. `opposite` is as in Linked. Cost:
/// linear.
template <typename Begin, typename Place>
void each_fan(const std::vector<std::uint32_t>& opposite, const Begin& begin, const Place& place) {
  std::vector<std::uint8_t> is_placed(opposite.size(), 0);
  const auto put = [&](std::uint32_t corner) {
    is_placed[corner] = 1;
    place(corner);
  };
  for (std::uint32_t first = 0; first < opposite.size(); ++first) {
    if (is_placed[first]) continue;
    begin(first);
    // All round the point one way; at a boundary the rest of the fan lies the other way.
    std::uint32_t turning = first;
    do {
      put(turning);
      turning = opposite[turning] == Linked::none ? Linked::none : next_corner(opposite[turning]);
    } while (turning != Linked::none && turning != first);
    for (turning = turning == Linked::none ? opposite[previous_corner(first)] : Linked::none;
         turning != Linked::none; turning = opposite[previous_corner(turning)])
      put(turning);
  }
}

/// All sides, ordered by `low`, `high` and `corner`: those of one edge stand together. Preconditions as
/// SidesOfPoints. Cost: linear where few triangles meet in a point, parallel; 16 bytes a side.
std::vector<Side> sorted_sides(const Triangles& triangles);

}  // namespace octotomy::brep
