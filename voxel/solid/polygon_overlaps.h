// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

// Polygons of one plane of which the even-odd rule makes something else than was drawn. Nested polygons and
// keyholes are none of these.
namespace octotomy::voxel {

/// Numbers, ascending, of the polygons that are the same closed line as an earlier one: each one's points lie
/// within the rounding of the other's edges, from any first point and in either direction. `rounding_mm` is
/// how far a coordinate may be off; of a polygon less than a thousand times as large, a thousandth of its
/// size. Preconditions: all coordinates finite. Cost: n log n in the points, and the pairs of polygons that
/// share bounds, area and centre.
std::vector<std::size_t> repeated_polygons(const std::vector<std::vector<glm::dvec2>>& polygons_mm,
                                           double rounding_mm);

/// A polygon that crosses another, or itself.
struct CrossingPolygon {
  std::size_t polygon = 0;
  glm::dvec2 at_mm{0.0};  ///< on its line, near a crossing
};

struct CrossingPolygons {
  std::vector<CrossingPolygon> all;  ///< each polygon once, ascending
  bool is_complete = true;           ///< false: too many edges lie over each other, and some were not asked
};

/// Polygons of which a part further than the rounding lies within another polygon and a part outside of it,
/// and the other way round; and polygons whose own line encloses a part twice or two parts in a figure of
/// eight. `rounding_mm` and preconditions as of repeated_polygons(), whose polygons are left out beforehand.
/// Cost: n log n in the edges where few of their boxes overlap; it ends, incomplete, after a fixed number of
/// pairs of edges for each edge.
CrossingPolygons crossing_polygons(const std::vector<std::vector<glm::dvec2>>& polygons_mm,
                                   double rounding_mm);

}  // namespace octotomy::voxel
