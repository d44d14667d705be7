// SPDX-License-Identifier: AGPL-3.0-or-later
// From inside, a ball can touch a reentrant edge along every direction between the normals of its two faces.
// The bisector is the direction of a neck's waist for any two sides.
#include "brep/measure/necks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <tbb/parallel_for.h>

#include "brep/measure/inscribed_balls.h"
#include "brep/mesh/error.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

/// Places of the surface within `own_side_deg` of the edge, seen from a ball's centre, are on the edge's own side of
/// the neck; the other side is at least `opposite_deg` from it.
struct Sides {
  double own_side_deg = 30.0, opposite_deg = 120.0;
};
/// The second kind ignores the teeth of a jagged edge, which would shrink a ball, but needs sides that are nearly
/// parallel: a wave of a rim is no neck.
constexpr std::array<Sides, 2> kinds_of_sides{Sides{30.0, 120.0}, Sides{90.0, 150.0}};

/// Edges shorter than this share of the spacing belong to slivers, whose normals may point anywhere.
constexpr double least_edge_share = 0.1;

double rad(double deg) {
  return deg * std::numbers::pi / 180.0;
}

/// A place on a reentrant edge, with the bisector of its faces' outward normals.
struct OnEdge {
  glm::dvec3 p_mm{0.0}, outward{0.0};
};

std::optional<glm::dvec3> normal_of(const Triangles& triangles, std::uint32_t face) {
  const auto& [a, b, c] = triangles.faces[face];
  const glm::dvec3 across = glm::cross(triangles.points_mm[b] - triangles.points_mm[a],
                                       triangles.points_mm[c] - triangles.points_mm[a]);
  const double length = glm::length(across);
  if (!(length > 0.0)) return std::nullopt;
  return across / length;
}

std::vector<OnEdge> places_of(const Linked& surface, const NecksOptions& options) {
  const Triangles& triangles = surface.triangles;
  const double most_cosine = std::cos(rad(options.reentrant_deg));
  std::vector<OnEdge> places;
  for (std::uint32_t side = 0; side < surface.opposite.size(); ++side) {
    if (!surface.is_inner_edge(side)) continue;
    const std::optional<glm::dvec3> here = normal_of(triangles, side / 3),
                                    beside = normal_of(triangles, surface.opposite[side] / 3);
    if (!here || !beside || glm::dot(*here, *beside) > most_cosine) continue;
    const glm::dvec3 &from_mm = triangles.points_mm[surface.from(side)],
                     &to_mm = triangles.points_mm[surface.to(side)];
    const double length_mm = glm::distance(from_mm, to_mm);
    if (length_mm < least_edge_share * options.spacing_mm) continue;
    // A triangle lies to the left of its side. At a reentrant edge, the normal turns clockwise about that
    // side from this triangle to its neighbour.
    if (!(glm::dot(glm::cross(*here, *beside), to_mm - from_mm) < 0.0)) continue;
    const glm::dvec3 sum = *here + *beside;
    if (!(glm::length(sum) > 0.0)) continue;
    const int count = std::max(1, static_cast<int>(std::ceil(length_mm / options.spacing_mm)));
    for (int i = 0; i < count; ++i)
      places.push_back({glm::mix(from_mm, to_mm, (i + 0.5) / count), glm::normalize(sum)});
  }
  return places;
}

void check(const Solid& solid, const NecksOptions& options) {
  if (solid.empty()) throw InvalidInput("necks: the solid is empty");
  if (!(options.below_mm > 0.0) || !(options.spacing_mm > 0.0))
    throw InvalidInput("necks: the width and the spacing must be above 0 mm");
  if (!(options.reentrant_deg >= 1.0 && options.reentrant_deg <= 170.0))
    throw InvalidInput("necks: the angle of reentrant edges must be from 1 to 170 degrees");
}

}  // namespace

std::vector<Neck> necks(const Solid& solid, const NecksOptions& options) {
  check(solid, options);
  const std::vector<OnEdge> places = places_of(solid.linked(), options);
  if (places.empty()) return {};
  const InscribedBalls inscribed(solid.triangles());
  std::vector<std::optional<Neck>> at(places.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    if (options.stop.stop_requested()) return;
    const auto& [p_mm, outward] = places[i];
    const double ray_mm = inscribed.ray_mm(p_mm, outward);
    if (!std::isfinite(ray_mm)) return;
    for (const Sides& sides : kinds_of_sides) {
      const Ball ball = inscribed.touching(p_mm, outward, ray_mm, std::cos(rad(sides.own_side_deg)));
      if (2.0 * ball.radius_mm >= options.below_mm || !(ball.radius_mm > 0.0) ||
          !inscribed.touches_opposite(ball, p_mm, rad(sides.opposite_deg)))
        continue;
      at[i] = Neck{ball.centre_mm, 2.0 * ball.radius_mm};
      return;
    }
  });
  if (options.stop.stop_requested()) throw Stopped("necks: stopped");
  std::vector<Neck> found;
  for (const std::optional<Neck>& neck : at)
    if (neck) found.push_back(*neck);
  return found;
}

}  // namespace octotomy::brep
