// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "voxel/space/view.h"

namespace octotomy::voxel {

/// Closed polygons drawn in a view, in the view's millimetres. Which points are inside follows from the
/// even-odd rule over all polygons, so a polygon within another is a hole. The closing edge is implied.
struct Region {
  View view;
  std::vector<std::vector<glm::dvec2>> polygons_mm;
};

/// A volume of interest: the points whose projections lie inside the regions of all views (thesis 6.2). A
/// mask stores regions instead of voxels, so the regions can be edited at any time.
struct RegionMask {
  std::vector<Region> regions;
};

/// Throws std::invalid_argument with the region and the polygon concerned, if there are no regions or
/// polygons, or a polygon has fewer than three points, a coordinate that is not finite, or no area.
void check(const RegionMask& mask);

/// Whether an edge from a to b crosses the ray from p towards growing x. The even-odd rule counts these
/// crossings. The edge is half open in y: of two edges that continue through a vertex upwards or downwards, a
/// ray through the vertex crosses exactly one.
inline bool crosses_ray_from(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p_mm) {
  return (a.y > p_mm.y) != (b.y > p_mm.y) && p_mm.x < (b.x - a.x) * (p_mm.y - a.y) / (b.y - a.y) + a.x;
}

/// Calls `visit(from, to)` for every edge of the polygons, closing edges included.
template <typename Visit>
void for_each_edge(const std::vector<std::vector<glm::dvec2>>& polygons_mm, const Visit& visit) {
  for (const std::vector<glm::dvec2>& polygon : polygons_mm)
    for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++)
      visit(polygon[last], polygon[i]);
}

/// Whether a point is inside a region, by the even-odd rule over all its polygons, or inside a mask, which
/// means inside every region of the mask.
bool contains(const std::vector<std::vector<glm::dvec2>>& polygons_mm, const glm::dvec2& p_mm);
bool contains(const Region& region, const glm::dvec2& p_mm);
bool contains(const RegionMask& mask, const glm::dvec3& p_mm);

}  // namespace octotomy::voxel
