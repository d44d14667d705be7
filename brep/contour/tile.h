// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/contour/span_clearance.h"
#include "brep/contour/surface_clearance.h"

namespace octotomy::brep {

/// The criterion by which a strip of triangles between two contours is chosen.
enum class TileCost {
  shortest_span,    ///< the nearer of the two next points, step by step (Christiansen and Sederberg 1978)
  least_area,       ///< the least sum of areas (Fuchs, Kedem and Uselton 1977)
  greatest_volume,  ///< the most volume on the object's side (Keppel 1975)
  least_angle       ///< the least sum of angles between successive triangles (Cook et al. 1983)
};

/// A closed contour at a height. With x to the right and y up, the object is on its left.
struct Ring {
  std::vector<glm::dvec2> points_mm;
  double z_mm = 0.0;
};

/// The closed strip of m + n triangles between two rings, oriented outward: points 0..m-1 are those of the
/// lower ring, those of the upper ring follow. least_area and greatest_volume are optimal among all strips.
/// The other two start at the span that is shortest after both rings' boxes are scaled to coincide, so that
/// shifted shapes are matched by shape; least_angle is optimal among the strips through this span. A strip
/// may cross itself if the rings differ much. Throws std::invalid_argument if a ring has fewer than three
/// points or the lower one is not lower, Error (Resource) if tables would take more than a gigabyte. Cost:
/// time m n with a small factor, plus time for each pair of points that may be on the best strip: few pairs
/// for least_area between similar rings, all pairs for least_angle and greatest_volume; at worst m n log n,
/// and 2 m n bytes. Source: the papers named above.
std::vector<std::array<std::uint32_t, 3>> tile(const Ring& lower, const Ring& upper, TileCost cost);

/// The best strip by the cost among those near the strip of shortest spans: at each lower point, the strip's
/// spans end at most `band` upper points before or after those of the shortest spans. With a band of 0 it is
/// the strip of shortest spans. Throws and costs as tile().
std::vector<std::array<std::uint32_t, 3>> tile_near(const Ring& lower, const Ring& upper, TileCost cost,
                                                    std::size_t band);

/// The best strip by the cost among those whose spans cross the fewest sides of contours in projection and
/// lie over the area of exactly one ring. This keeps a strip from crossing itself: apart from crossings of
/// the rings themselves, such a strip exists unless one ring has folds that are invisible from the other.
/// Spans longer than twice the largest distance from a point to the nearest point of the other ring, plus the
/// longest side, count as crossing the most sides. `avoided` lists triangles of earlier strips of these rings
/// that crossed another triangle, once for each crossing. Each entry has the weight of a side that a span
/// crosses. shortest_span and least_angle start at the shortest of the best spans. With triangles to avoid,
/// shortest_span minimises the sum of its spans instead of choosing step by step, because a single step does
/// not show which triangles follow; rings too long for the tables are still tiled step by step. If the best
/// strip by least_area or greatest_volume is no surface but two cones that meet at one span, returns the best
/// surface that contains this span. `scores` stores a byte per pair of points between calls for the same
/// rings and sides; pass an empty list to the first call. Throws and costs as tile(), plus, for each span
/// that a good strip may contain, a test against the sides near the span.
std::vector<std::array<std::uint32_t, 3>> tile_clear(
    const Ring& lower, const Ring& upper, TileCost cost, const SpanClearance& sides,
    std::vector<std::uint8_t>& scores, const std::vector<std::array<std::uint32_t, 3>>& avoided = {});

/// As above, but both rings are scaled for the test so that their boxes coincide, and are tested against
/// their own sides only. This serves thin walls that lean by more than their thickness: a good span of the
/// outer side then crosses the inner side in projection, but nothing in space.
std::vector<std::array<std::uint32_t, 3>> tile_clear_aligned(
    const Ring& lower, const Ring& upper, TileCost cost, std::vector<std::uint8_t>& scores,
    const std::vector<std::array<std::uint32_t, 3>>& avoided = {});

/// The strip of shortest spans among those whose spans cross the fewest triangles of other surfaces, in space.
/// This serves rings one of which reaches past the end of the other, beside a further contour: every strip crosses
/// that contour in projection, but there may be one below its roof. The strip may cross itself; `avoided` is as for
/// tile_clear(). Throws and costs as tile_clear().
std::vector<std::array<std::uint32_t, 3>> tile_apart(
    const Ring& lower, const Ring& upper, const SurfaceClearance& others,
    const std::vector<std::array<std::uint32_t, 3>>& avoided = {});

/// As tile_near(), about a given strip of these rings instead of the strip of shortest spans. Throws
/// std::invalid_argument, too, if the strip has another number of triangles.
std::vector<std::array<std::uint32_t, 3>> tile_about(const Ring& lower, const Ring& upper, TileCost cost,
                                                     std::size_t band,
                                                     const std::vector<std::array<std::uint32_t, 3>>& strip);

}  // namespace octotomy::brep
