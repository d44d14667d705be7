// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/column_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "voxel/tree/octree_node.h"
#include "voxel/view/depth_plane.h"

namespace octotomy::voxel {
namespace {

/// For one axis of the picture, the map's columns between which each row or column of pixels lies.
struct AxisColumns {
  int nearest = -1;  ///< -1: outside
  int low = 0, high = 0;
  float low_weight = 0.0f, high_weight = 0.0f;
};

std::vector<AxisColumns> places(int pixel_count, double first, double per_px, int side) {
  std::vector<AxisColumns> places(static_cast<std::size_t>(pixel_count));
  for (int i = 0; i < pixel_count; ++i) {
    const double at = first + (i + 0.5) * per_px;
    const double nearest = std::floor(at + 0.5);
    if (!(nearest >= 0.0 && nearest < side)) continue;
    const double low = std::floor(at);
    const auto t = static_cast<float>(at - low);
    AxisColumns& place = places[static_cast<std::size_t>(i)];
    place.nearest = static_cast<int>(nearest);
    // Columns beyond the map have no weight.
    place.low = std::max(0, static_cast<int>(low));
    place.high = std::min(side - 1, static_cast<int>(low) + 1);
    place.low_weight = low >= 0.0 ? 1.0f - t : 0.0f;
    place.high_weight = low + 1.0 < side ? t : 0.0f;
  }
  return places;
}

}  // namespace

DepthImage picture_of(const ColumnMap& map, const AxisView& axes, const VoxelRays& rays,
                      const glm::ivec2& size_px) {
  DepthImage image = unset(size_px);
  const std::vector<AxisColumns> across =
      places(size_px.x, rays.first[axes.axis[0]], rays.per_px_x[axes.axis[0]], map.side);
  const std::vector<AxisColumns> down =
      places(size_px.y, rays.first[axes.axis[1]], rays.per_px_y[axes.axis[1]], map.side);
  const auto limit_mm = static_cast<float>(break_mm(std::max(map.spacing_mm.x, map.spacing_mm.y)));
  tbb::parallel_for(tbb::blocked_range<int>(0, size_px.y, 8), [&](const tbb::blocked_range<int>& range) {
    for (int y = range.begin(); y < range.end(); ++y) {
      const AxisColumns& j = down[static_cast<std::size_t>(y)];
      Seen* const pixel = &image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_px.x)];
      std::fill_n(pixel, across.size(), Seen{});
      if (j.nearest < 0) continue;
      const Seen* const nearest = &map.at(0, j.nearest);
      const Seen* const low = &map.at(0, j.low);
      const Seen* const high = &map.at(0, j.high);
      for (std::size_t x = 0; x < across.size(); ++x) {
        const AxisColumns& i = across[x];
        if (i.nearest < 0 || !nearest[i.nearest].lit()) continue;
        const Seen answer = nearest[i.nearest];
        float sum = 0.0f;
        float weights = 0.0f;
        const auto weigh = [&](const Seen& other, float weight) {
          const bool goes_on =
              other.object == answer.object && std::abs(other.depth_mm - answer.depth_mm) <= limit_mm;
          weight = goes_on ? weight : 0.0f;
          sum += goes_on ? weight * (other.depth_mm - answer.depth_mm) : 0.0f;
          weights += weight;
        };
        weigh(low[i.low], j.low_weight * i.low_weight);
        weigh(low[i.high], j.low_weight * i.high_weight);
        weigh(high[i.low], j.high_weight * i.low_weight);
        weigh(high[i.high], j.high_weight * i.high_weight);
        // The sum of weights is not zero, because the nearest column has a weight of at least a quarter.
        pixel[x] = {answer.depth_mm + sum / weights, answer.object, answer.stepped};
      }
    }
  });
  return image;
}

ColumnSurface::ColumnSurface(const DrawnObject& object, const AxisView& axes)
    : object_(object),
      axes_(axes),
      spacing_mm_(object.octree.universe().lattice().spacing_mm()[axes.axis[2]]) {
  if (object.grey && object.moved_from_still) moved_.emplace(object);
}

glm::ivec3 ColumnSurface::voxel(const glm::ivec2& column, int before) const {
  glm::ivec3 at;
  at[axes_.axis[0]] = column.x;
  at[axes_.axis[1]] = column.y;
  at[axes_.axis[2]] = axes_.reversed[2] ? object_.octree.universe().side() - 1 - before : before;
  return at;
}

std::optional<Seen> ColumnSurface::seen_moved(const glm::ivec2& column, int before) const {
  // The ray through the column's centre, starting at the universe's front face.
  const int look = axes_.axis[2];
  const double forward = axes_.reversed[2] ? -1.0 : 1.0;
  VoxelRay ray{glm::dvec3(voxel(column, 0)), glm::dvec3(0.0)};
  ray.start[look] -= 0.5 * forward;
  ray.per_mm[look] = forward / spacing_mm_;
  return moved_->seen_moved(ray, {{}, before * spacing_mm_, (before + 1) * spacing_mm_, look});
}

Seen ColumnSurface::seen(const glm::ivec2& column, int before) const {
  Seen seen{static_cast<float>(before * spacing_mm_), 0, true};
  if (moved_) return seen_moved(column, before).value_or(seen);
  if (!object_.grey || before == 0) return seen;
  const double inside = object_.grey->sample(voxel(column, before));
  const double outside = object_.grey->sample(voxel(column, before - 1));
  const double threshold = object_.grey->in_steps(object_.threshold);
  if (outside < threshold && threshold <= inside) {
    // Voxel centres are half a voxel behind their front faces.
    const double depth_voxels = before - 0.5 + (threshold - outside) / (inside - outside);
    seen = {static_cast<float>(depth_voxels * spacing_mm_), 0, false};
  }
  return seen;
}

ColumnMap column_map(const std::vector<DrawnObject>& objects, const AxisView& axes,
                     const std::vector<std::vector<std::int32_t>>& before) {
  assert(!objects.empty() && before.size() == objects.size());
  const Universe& universe = objects.front().octree.universe();
  const glm::dvec3 spacing_mm = universe.lattice().spacing_mm();
  ColumnMap map{universe.side(), {spacing_mm[axes.axis[0]], spacing_mm[axes.axis[1]]}, {}};
  map.columns.resize(static_cast<std::size_t>(map.side) * static_cast<std::size_t>(map.side));
  std::vector<ColumnSurface> surfaces;
  for (const DrawnObject& each : objects) surfaces.emplace_back(each, axes);
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
      map.columns[entry] = surfaces[object].seen({i, j}, nearest);
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
  // The sum of weights is not zero, because the nearest column has a weight of at least a quarter.
  answer.depth_mm = static_cast<float>(sum / weights);
  return answer;
}

}  // namespace octotomy::voxel
