// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Sweep the part away from its place to before the object's near end.
// 2 Depth changes by at most the distance between points: a triangle's depth is at most the depth of its
//   middle plus the distance from there to its farthest corner. The depth is also at most the distance to any
//   one triangle of the space's surface. Over a piece that distance is largest at a corner; this bound is
//   tight where both surfaces are flat. Level by level, keep the triangles that can still be deeper than the
//   deepest place found, and cut each into four.
// 3 Follow the direction from the deepest place: the stretch inside the part shows when the part contains
// that place.
#include "brep/shape/seating.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/shape/shadow.h"

namespace octotomy::brep {
namespace {

using TrianglePoints = std::array<glm::dvec3, 3>;

glm::dvec3 middle_of(const TrianglePoints& piece) {
  return (piece[0] + piece[1] + piece[2]) / 3.0;
}
double reach_of(const TrianglePoints& piece) {
  const glm::dvec3 middle = middle_of(piece);
  return std::max(
      {glm::distance(middle, piece[0]), glm::distance(middle, piece[1]), glm::distance(middle, piece[2])});
}

/// The object's triangles that lie at least in part within the box of a space.
std::vector<TrianglePoints> pieces_near(const Solid& object, const Size& space) {
  std::vector<TrianglePoints> pieces;
  const Triangles& triangles = object.triangles();
  for (const auto& [a, b, c] : triangles.faces) {
    const TrianglePoints piece{triangles.points_mm[a], triangles.points_mm[b], triangles.points_mm[c]};
    const glm::dvec3 low = glm::min(glm::min(piece[0], piece[1]), piece[2]),
                     high = glm::max(glm::max(piece[0], piece[1]), piece[2]);
    if (glm::all(glm::lessThanEqual(low, space.high_mm)) &&
        glm::all(glm::greaterThanEqual(high, space.low_mm)))
      pieces.push_back(piece);
  }
  return pieces;
}

/// The largest depth that a piece can have, from its middle's depth and the triangle nearest to the middle.
double most_depth(const TrianglePoints& piece, double depth_mm, const std::array<std::uint32_t, 3>& nearest,
                  const Triangles& space) {
  double to_nearest = 0.0;
  const glm::dvec3 &a = space.points_mm[nearest[0]], &b = space.points_mm[nearest[1]],
                   &c = space.points_mm[nearest[2]];
  for (const glm::dvec3& p : piece)
    to_nearest = std::max(to_nearest, glm::distance(p, nearest_of_triangle(p, a, b, c)));
  return std::min(depth_mm + reach_of(piece), to_nearest);
}

std::optional<Binding> deepest(const Solid& object, const Solid& space, const SeatingOptions& options) {
  std::optional<Binding> found;
  std::vector<TrianglePoints> pieces = pieces_near(object, space.size());
  while (!pieces.empty()) {
    options.progress.at(0.5);
    std::vector<glm::dvec3> middles;
    middles.reserve(pieces.size());
    for (const TrianglePoints& piece : pieces) middles.push_back(middle_of(piece));
    const std::vector<Foot> feet = space.tree().feet(middles);
    const std::vector<std::uint8_t> inside = space.tree().inside(middles);
    std::vector<double> depths;
    for (std::size_t i = 0; i < pieces.size(); ++i)
      depths.push_back(inside[i] != 0 ? feet[i].distance_mm : -feet[i].distance_mm);
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (depths[i] > (found ? found->depth_mm : options.resolution_mm))
        found = {middles[i], depths[i], 0, 0};
    const double least = found ? found->depth_mm + options.resolution_mm : 2.0 * options.resolution_mm;
    std::vector<TrianglePoints> halves;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const auto& nearest = space.triangles().faces[feet[i].face];
      if (most_depth(pieces[i], depths[i], nearest, space.triangles()) <= least) continue;
      const auto& [a, b, c] = pieces[i];
      const glm::dvec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
      for (const TrianglePoints& half : {TrianglePoints{a, ab, ca}, TrianglePoints{ab, b, bc},
                                         TrianglePoints{ca, bc, c}, TrianglePoints{ab, bc, ca}})
        halves.push_back(half);
    }
    pieces = std::move(halves);
  }
  return found;
}

/// Finds how far before its place the part begins and ceases to contain a point: a ray from the point along
/// the direction meets the part's surface first and last at these distances.
void find_times(const Solid& part, const glm::dvec3& direction, Binding& binding) {
  // Rays go towards +x.
  const glm::dvec3 beside = std::abs(direction.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 y = glm::normalize(glm::cross(direction, beside));
  const glm::dmat3 turned_from_lps = glm::transpose(glm::dmat3(direction, y, glm::cross(direction, y)));
  Triangles turned = part.triangles();
  for (glm::dvec3& p : turned.points_mm) p = turned_from_lps * p;
  const glm::dvec3 from = turned_from_lps * binding.at_mm;
  double last = std::numeric_limits<double>::infinity(), first = 0.0;
  bool is_inside = false;
  for (const Crossing& crossing : SurfaceTree(turned, SurfaceTree::Build::Hasty).crossings(from)) {
    const auto& [a, b, c] = turned.faces[crossing.face];
    const glm::dvec3 &p = turned.points_mm[a], &q = turned.points_mm[b], &r = turned.points_mm[c];
    const glm::dvec3 normal = glm::cross(q - p, r - p);
    const double along = normal.x != 0.0 ? glm::dot(normal, p - from) / normal.x : p.x - from.x;
    first = std::max(first, along);
    if (along < last) {
      last = along;
      is_inside = crossing.leaving;
    }
  }
  binding.first_mm = first;
  binding.last_mm = is_inside || !std::isfinite(last) ? 0.0 : std::max(0.0, last);
}

}  // namespace

Seating seating(const Solid& part, const Solid& object, const SeatingOptions& options) {
  if (part.empty() || object.empty()) throw InvalidInput("seating needs a part and an object");
  if (!(options.resolution_mm > 0.0)) throw InvalidInput("the resolution of depths must be above 0 mm");
  const glm::dvec3 away = -options.direction;
  // The part's path begins far enough before the object that the part does not touch the object.
  const glm::dvec3 extent = part.size().high_mm - part.size().low_mm;
  const double end_mm = std::max(far_end_mm(part, away), far_end_mm(object, away) + glm::length(extent));
  const Shadow swept = shadow(part, {away, end_mm, options.progress});
  Seating made{deepest(object, swept.solid, options), volume_mm3(swept.solid)};
  if (made.binding) find_times(part, options.direction, *made.binding);
  return made;
}

}  // namespace octotomy::brep
