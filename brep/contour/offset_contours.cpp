// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/offset_contours.h"

#include <boost/geometry.hpp>
#include <boost/geometry/geometries/multi_polygon.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <boost/geometry/geometries/register/point.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "brep/mesh/error.h"

BOOST_GEOMETRY_REGISTER_POINT_2D(glm::dvec2, double, boost::geometry::cs::cartesian, x, y)

namespace octotomy::brep {
namespace {

namespace bg = boost::geometry;
using Polygon =
    bg::model::polygon<glm::dvec2, false, false>;  // counter-clockwise, the last point not repeated
using Polygons = bg::model::multi_polygon<Polygon>;

Polygon::ring_type ring_of(const Contour& contour) {
  return {contour.points_mm.begin(), contour.points_mm.end()};
}

Contour contour_of(const Polygon::ring_type& ring) {
  return {{ring.begin(), ring.end()}};
}

/// Contours at an even depth are polygons; those at an odd depth are holes of the polygon around them.
Polygons polygons_of(const std::vector<Contour>& contours) {
  const auto around = nest(contours);
  const std::vector<std::size_t> depth = depths(around);
  std::vector<std::size_t> polygon(contours.size(), 0);
  Polygons polygons;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    if (depth[i] % 2 == 1) continue;
    polygon[i] = polygons.size();
    polygons.emplace_back();
    polygons.back().outer() = ring_of(contours[i]);
  }
  for (std::size_t i = 0; i < contours.size(); ++i)
    if (depth[i] % 2 == 1) polygons[polygon[*around[i]]].inners().push_back(ring_of(contours[i]));
  bg::correct(polygons);
  std::string reason;
  if (!bg::is_valid(polygons, reason))
    throw InvalidInput("contours that cross or touch have no offset: " + reason);
  return polygons;
}

/// The number of chords of a circle that deviate from it by less than a thousandth of its radius.
const std::size_t chords = static_cast<std::size_t>(std::ceil(std::numbers::pi / std::acos(1.0 - 1e-3)));

}  // namespace

std::vector<Contour> offset(const std::vector<Contour>& contours, double by_mm) {
  if (!std::isfinite(by_mm)) throw InvalidInput("an offset's length must be finite");
  const Polygons polygons = polygons_of(contours);
  Polygons grown;
  if (by_mm == 0.0)
    grown = polygons;
  else
    bg::buffer(polygons, grown, bg::strategy::buffer::distance_symmetric<double>(by_mm),
               bg::strategy::buffer::side_straight(), bg::strategy::buffer::join_round(chords),
               bg::strategy::buffer::end_flat(), bg::strategy::buffer::point_circle(chords));
  std::vector<Contour> result;
  for (const Polygon& polygon : grown) {
    result.push_back(contour_of(polygon.outer()));
    for (const auto& hole : polygon.inners()) result.push_back(contour_of(hole));
  }
  return result;
}

}  // namespace octotomy::brep
