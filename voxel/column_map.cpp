// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/column_map.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>

#include "voxel/octree_node.h"
#include "voxel/surface_break.h"

namespace octotomy::voxel {
namespace {

double sample_at(const GreyOctree& grey, const glm::ivec3& voxel) {
  const glm::ivec3 leaf = (voxel >> 2) & 3;
  const glm::ivec3 bit = voxel & 3;
  return grey.brick(voxel >> 4)
      .samples[static_cast<std::size_t>(child_index(leaf.x, leaf.y, leaf.z))]
              [static_cast<std::size_t>(child_index(bit.x, bit.y, bit.z))];
}

}  // namespace

Seen seen_in_column(const Drawn& object, const AxisView& axes, const glm::ivec2& column, int before) {
  const Universe& universe = object.octree.universe();
  Seen seen{0.0f, 0, true};
  double depth_voxels = before;
  if (object.grey && before > 0) {
    const auto voxel = [&](int d) {
      glm::ivec3 at;
      at[axes.axis[0]] = column.x;
      at[axes.axis[1]] = column.y;
      at[axes.axis[2]] = axes.reversed[2] ? universe.side() - 1 - d : d;
      return at;
    };
    const double inside = sample_at(*object.grey, voxel(before));
    const double outside = sample_at(*object.grey, voxel(before - 1));
    if (outside < object.threshold && object.threshold <= inside) {
      // Voxel centres are half a voxel behind their front faces.
      depth_voxels = before - 0.5 + (object.threshold - outside) / (inside - outside);
      seen.stepped = false;
    }
  }
  seen.depth_mm = static_cast<float>(depth_voxels * universe.lattice().spacing_mm()[axes.axis[2]]);
  return seen;
}

ColumnMap column_map(const std::vector<Drawn>& objects, const AxisView& axes,
                     const std::vector<std::vector<std::int32_t>>& before) {
  const Universe& universe = objects.front().octree.universe();
  const glm::dvec3 spacing_mm = universe.lattice().spacing_mm();
  ColumnMap map{universe.side(), {spacing_mm[axes.axis[0]], spacing_mm[axes.axis[1]]}, {}};
  map.columns.resize(static_cast<std::size_t>(map.side) * static_cast<std::size_t>(map.side));
  tbb::parallel_for(0, map.side, [&](int j) {
    for (int i = 0; i < map.side; ++i) {
      const std::size_t entry =
          static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * static_cast<std::size_t>(map.side);
      std::int32_t nearest = -1;
      std::size_t object = 0;
      for (std::size_t o = 0; o < objects.size(); ++o)
        if (before[o][entry] >= 0 && (nearest < 0 || before[o][entry] < nearest)) {
          nearest = before[o][entry];
          object = o;
        }
      if (nearest < 0) continue;
      map.columns[entry] = seen_in_column(objects[object], axes, {i, j}, nearest);
      map.columns[entry].object = static_cast<std::int16_t>(object);
    }
  });
  return map;
}

Seen ColumnMap::seen(const glm::dvec2& column) const {
  const glm::dvec2 nearest = glm::floor(column + 0.5);
  if (!(nearest.x >= 0.0 && nearest.y >= 0.0 && nearest.x < side && nearest.y < side)) return {};
  Seen answer = at(static_cast<int>(nearest.x), static_cast<int>(nearest.y));
  if (!answer.lit()) return answer;
  const glm::dvec2 low = glm::floor(column);
  const glm::dvec2 t = column - low;
  const auto limit_mm = static_cast<float>(break_mm(std::max(spacing_mm.x, spacing_mm.y)));
  double sum = 0.0;
  double weights = 0.0;
  for (int corner = 0; corner < 4; ++corner) {
    const int i = static_cast<int>(low.x) + (corner & 1);
    const int j = static_cast<int>(low.y) + (corner >> 1);
    if (i < 0 || j < 0 || i >= side || j >= side) continue;
    const Seen& other = at(i, j);
    if (other.object != answer.object || !(std::abs(other.depth_mm - answer.depth_mm) <= limit_mm)) continue;
    const double weight = ((corner & 1) != 0 ? t.x : 1.0 - t.x) * ((corner >> 1) != 0 ? t.y : 1.0 - t.y);
    sum += weight * other.depth_mm;
    weights += weight;
  }
  // The nearest column itself has a weight of a quarter at least.
  answer.depth_mm = static_cast<float>(sum / weights);
  return answer;
}

}  // namespace octotomy::voxel
