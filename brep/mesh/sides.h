// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Side `corner % 3` of triangle `corner / 3`, from that corner to the next.
struct Side {
  std::uint32_t low, high, corner;  ///< points, the lower number first, and the corner
  bool upward;                      ///< runs from the lower point number to the higher
};

constexpr std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}
constexpr std::uint32_t previous_corner(std::uint32_t corner) {
  return corner % 3 == 0 ? corner + 2 : corner - 1;
}

/// Splits the points of a surface among threads without locks.
class PointShares {
 public:
  /// Cost: linear, parallel.
  explicit PointShares(const Triangles& triangles);

  /// Calls visit(first, end, each) for shares of the points, first..end - 1, from several threads. each(take)
  /// calls take(f), in ascending order, for all triangles with a point of the share, and for some other
  /// triangles. Cost besides the calls: one pass over the triangles if they are roughly in the order of their
  /// points, else one per share.
  template <typename Visit>
  void visit(const Visit& visit) const {
    const std::size_t points = triangles_.points_mm.size();
    const auto shares = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    tbb::parallel_for(std::size_t{0}, shares, [&](std::size_t share) {
      const auto first = static_cast<std::uint32_t>(points * share / shares);
      const auto end = static_cast<std::uint32_t>(points * (share + 1) / shares);
      visit(first, end, [&](const auto& take) {
        for (std::size_t b = 0; b < blocks_.size(); ++b)
          if (blocks_[b].low < end && blocks_[b].high >= first)
            for (std::size_t f = b * block; f < std::min((b + 1) * block, triangles_.faces.size()); ++f)
              take(static_cast<std::uint32_t>(f));
      });
    });
  }

 private:
  static constexpr std::size_t block = 1024;
  struct Points {
    std::uint32_t low, high;
  };
  const Triangles& triangles_;
  std::vector<Points> blocks_;  ///< range of points of each block of triangles
};

/// The sides of triangles by the lower of their points. Preconditions: every triangle refers to existing
/// points; 32-bit numbers can name all corners. Cost: linear; 4 bytes per side and 4 per point.
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
  std::vector<std::uint32_t> end_;            ///< for each point, where its sides end in corners_
  std::unique_ptr<std::uint32_t[]> corners_;  ///< the corner at which each side starts
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

/// As each_edge(), but from several threads, with edges in arbitrary order; the sides of one edge are ordered
/// by `corner`. Preconditions are those of SidesOfPoints.
template <typename Visit>
void each_edge_in_parallel(const SidesOfPoints& sides, const Visit& visit) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sides.point_count(), 4096), [&](const auto& range) {
    std::vector<Side> of_point;
    for (std::size_t point = range.begin(); point != range.end(); ++point) {
      of_point.resize(sides.end(point) - sides.first(point));
      sides.put(point, of_point.data());
      each_edge(of_point, visit);
    }
  });
}

template <typename Visit>
void each_edge_in_parallel(const Triangles& triangles, const Visit& visit) {
  each_edge_in_parallel(SidesOfPoints(triangles), visit);
}

/// Calls begin(corner) for the first corner of each fan (the triangles around a point that are joined by
/// sides), in ascending order, and place(corner) for each corner of the fan. `opposite` is as in Linked.
/// Cost: linear.
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
    // Walks around the point in one direction; from a boundary, continues in the other direction.
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

/// All sides, ordered by `low`, `high` and `corner`: those of one edge are adjacent. Preconditions are those
/// of SidesOfPoints. Cost: linear if few triangles meet in a point, parallel; 16 bytes per side.
std::vector<Side> sorted_sides(const Triangles& triangles);

}  // namespace octotomy::brep
