// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

// Finds polygons in one plane for which the even-odd rule yields a region other than the one drawn: repeated
// and crossing polygons. Nested polygons and keyholes are not reported.
namespace octotomy::voxel {

/// The numbers, ascending, of the polygons that repeat an earlier one: the points of each are within the
/// rounding of the other's edges. First point and direction may differ. `rounding_mm` is the largest error of
/// a coordinate; for a polygon smaller than 1000 times this error, a thousandth of its size is used instead.
/// Precondition: all coordinates are finite. Cost: n log n in the points, plus one comparison per pair of
/// polygons that share bounds, area and centre.
std::vector<std::size_t> repeated_polygons(const std::vector<std::vector<glm::dvec2>>& polygons_mm,
                                           double rounding_mm);

/// A polygon that crosses another, or itself.
struct CrossingPolygon {
  std::size_t polygon = 0;
  glm::dvec2 at_mm{0.0};  ///< a point on the polygon, near a crossing
};

struct CrossingPolygons {
  std::vector<CrossingPolygon> all;  ///< each polygon once, ascending
  /// False if the search stopped at its limit, with some pairs of edges unchecked.
  bool is_complete = true;
};

/// The polygons that cross another one, and those that cross themselves. Of two crossing polygons each has a
/// part inside and a part outside the other, both farther than the rounding from the other's line. A polygon
/// that crosses itself encloses a part twice or is a figure of eight. `rounding_mm` and preconditions as in
/// repeated_polygons(); the caller first removes the polygons that repeated_polygons() returns. Cost: n log n
/// in the edges if few of their boxes overlap. The search stops early, with `is_complete` false, after a
/// fixed number of pairs of edges per edge.
CrossingPolygons crossing_polygons(const std::vector<std::vector<glm::dvec2>>& polygons_mm,
                                   double rounding_mm);

}  // namespace octotomy::voxel
