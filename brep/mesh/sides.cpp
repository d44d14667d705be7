// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 count the sides of each lower point; 2 lay them out by it, in the order of their corners; 3 sort the few
// sides of each point by the other.
#include "brep/mesh/sides.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace octotomy::brep {

std::vector<Side> sorted_sides(const Triangles& triangles) {
  std::vector<std::uint32_t> begin(triangles.points_mm.size() + 1, 0);
  for (const auto& face : triangles.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      assert(face[k] < triangles.points_mm.size());
      ++begin[std::min(face[k], face[(k + 1) % 3]) + 1];
    }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Side> sides(3 * triangles.faces.size());
  for (std::uint32_t f = 0; f < triangles.faces.size(); ++f) {
    const auto& face = triangles.faces[f];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = face[k], to = face[(k + 1) % 3], low = std::min(from, to);
      sides[begin[low]++] = {low, std::max(from, to), 3 * f + k, from < to};
    }
  }
  // By now `begin` holds where the sides of each point end.
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.points_mm.size(), 4096),
                    [&](const auto& range) {
                      for (std::size_t v = range.begin(); v != range.end(); ++v)
                        std::sort(sides.begin() + (v == 0 ? 0 : begin[v - 1]), sides.begin() + begin[v],
                                  [](const Side& a, const Side& b) {
                                    return a.high != b.high ? a.high < b.high : a.corner < b.corner;
                                  });
                    });
  return sides;
}

}  // namespace octotomy::brep
