// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 count the sides of each lower point; 2 lay out their corners by it, in ascending order; 3 sort the few
// sides of each point by the other.
#include "brep/mesh/sides.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace octotomy::brep {

SidesOfPoints::SidesOfPoints(const Triangles& triangles)
    : triangles_(triangles), end_(triangles.points_mm.size(), 0), corners_(3 * triangles.faces.size()) {
  const auto low_of = [](const std::array<std::uint32_t, 3>& face, std::size_t k) {
    return std::min(face[k], face[k == 2 ? 0 : k + 1]);
  };
  for (const auto& face : triangles.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      assert(face[k] < end_.size());
      ++end_[low_of(face, k)];
    }
  std::uint32_t sum = 0;
  for (std::uint32_t& end : end_) {
    const std::uint32_t count = end;
    end = sum;  // where the point's sides begin: laying them out takes it to their end
    sum += count;
  }
  for (std::uint32_t f = 0; f < triangles.faces.size(); ++f)
    for (std::uint32_t k = 0; k < 3; ++k) corners_[end_[low_of(triangles.faces[f], k)]++] = 3 * f + k;
}

void SidesOfPoints::put(std::size_t point, Side* sides) const {
  Side* last = sides;
  for (std::size_t i = first(point); i != end(point); ++i) {
    const std::uint32_t corner = corners_[i];
    const auto& face = triangles_.faces[corner / 3];
    const std::uint32_t from = face[corner % 3], to = face[(corner + 1) % 3];
    *last++ = {std::min(from, to), std::max(from, to), corner, from < to};
  }
  std::sort(sides, last, [](const Side& a, const Side& b) {
    return a.high != b.high ? a.high < b.high : a.corner < b.corner;
  });
}

std::vector<Side> sorted_sides(const Triangles& triangles) {
  const SidesOfPoints of_points(triangles);
  std::vector<Side> sides(3 * triangles.faces.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, of_points.point_count(), 4096),
                    [&](const auto& range) {
                      for (std::size_t point = range.begin(); point != range.end(); ++point)
                        of_points.put(point, sides.data() + of_points.first(point));
                    });
  return sides;
}

}  // namespace octotomy::brep
