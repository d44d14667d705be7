// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/equal_points.h"

#include <numeric>
#include <tbb/parallel_sort.h>
#include <tuple>

namespace octotomy::brep {

std::vector<std::uint32_t> first_equal_points(const std::vector<glm::dvec3>& points_mm) {
  std::vector<std::uint32_t> order(points_mm.size()), first(points_mm.size());
  std::iota(order.begin(), order.end(), 0u);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t v, std::uint32_t w) {
    const glm::dvec3 &p = points_mm[v], &q = points_mm[w];
    return std::tie(p.x, p.y, p.z, v) < std::tie(q.x, q.y, q.z, w);
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] =
        i > 0 && points_mm[order[i]] == points_mm[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

}  // namespace octotomy::brep
