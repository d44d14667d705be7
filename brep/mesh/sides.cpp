// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 count the sides of each lower point; 2 store their corners by this point, in ascending order; 3 sort the
// few sides of each point by the other point.
#include "brep/mesh/sides.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace octotomy::brep {

PointShares::PointShares(const Triangles& triangles)
    : triangles_(triangles), blocks_((triangles.faces.size() + block - 1) / block) {
  tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t b) {
    Points points{triangles.faces[b * block][0], 0};
    for (std::size_t f = b * block; f < std::min((b + 1) * block, triangles.faces.size()); ++f)
      for (const std::uint32_t point : triangles.faces[f]) {
        assert(point < triangles.points_mm.size());
        points = {std::min(points.low, point), std::max(points.high, point)};
      }
    blocks_[b] = points;
  });
}

SidesOfPoints::SidesOfPoints(const Triangles& triangles)
    : triangles_(triangles),
      end_(triangles.points_mm.size(), 0),
      corners_(std::make_unique_for_overwrite<std::uint32_t[]>(3 * triangles.faces.size())) {
  const PointShares shares(triangles);
  // Each thread processes the sides whose lower points are in its share.
  const auto each_side = [&](const auto& take) {
    shares.visit([&](std::uint32_t first, std::uint32_t end, const auto& each) {
      each([&](std::uint32_t f) {
        const auto& face = triangles.faces[f];
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint32_t low = std::min(face[k], face[k == 2 ? 0 : k + 1]);
          if (low - first < end - first) take(low, 3 * f + k);
        }
      });
    });
  };
  each_side([&](std::uint32_t low, std::uint32_t) { ++end_[low]; });
  std::uint32_t sum = 0;
  for (std::uint32_t& end : end_) {
    const std::uint32_t count = end;
    end = sum;  // begins as the start of the point's sides; storing them moves it to their end
    sum += count;
  }
  each_side([&](std::uint32_t low, std::uint32_t corner) { corners_[end_[low]++] = corner; });
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
