// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/region_mask.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "voxel/solid/polygon.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

/// Twice the sum of the absolute areas of the triangles between the first point and each edge. It is zero
/// only if all points lie on a line.
double covered_area(const std::vector<glm::dvec2>& polygon) {
  double area = 0.0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i] - polygon[0], b = polygon[i + 1] - polygon[0];
    area += std::abs(a.x * b.y - a.y * b.x);
  }
  return area;
}

}  // namespace

void check(const RegionMask& mask) {
  if (mask.regions.empty()) throw InvalidInput("a mask needs at least one region drawn in a view");
  for (std::size_t r = 0; r < mask.regions.size(); ++r) {
    const std::string where = "region " + std::to_string(r + 1) + " of the mask";
    if (mask.regions[r].polygons_mm.empty()) throw InvalidInput(where + " has no polygon");
    for (std::size_t p = 0; p < mask.regions[r].polygons_mm.size(); ++p) {
      const std::vector<glm::dvec2>& polygon = mask.regions[r].polygons_mm[p];
      const std::string which = "polygon " + std::to_string(p + 1) + " of " + where;
      if (polygon.size() < 3)
        throw InvalidInput(which + " has " + std::to_string(polygon.size()) + " points: draw at least three");
      for (const glm::dvec2& point : polygon)
        if (!std::isfinite(point.x) || !std::isfinite(point.y))
          throw InvalidInput(which + " has a coordinate that is not a finite number");
      // Absolute areas are used, because the signed areas of a self-crossing polygon's loops may cancel.
      if (covered_area(polygon) == 0.0) throw InvalidInput(which + " encloses no area");
    }
  }
}

bool contains(const std::vector<std::vector<glm::dvec2>>& polygons_mm, const glm::dvec2& p_mm) {
  bool inside = false;
  for_each_edge(polygons_mm,
                [&](const glm::dvec2& a, const glm::dvec2& b) { inside ^= crosses_ray_from(a, b, p_mm); });
  return inside;
}

bool contains(const Region& region, const glm::dvec2& p_mm) {
  return contains(region.polygons_mm, p_mm);
}

bool contains(const RegionMask& mask, const glm::dvec3& p_mm) {
  return std::all_of(mask.regions.begin(), mask.regions.end(),
                     [&](const Region& region) { return contains(region, region.view.project(p_mm)); });
}

}  // namespace octotomy::voxel
