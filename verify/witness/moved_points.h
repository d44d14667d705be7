// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "brep/mesh/triangles.h"
#include "verify/witness/reading.h"
#include "verify/witness/reshaped_witness.h"

// Surfaces and witnesses of objects whose points move. The type `Motion` must have displacement_mm() and
// origin_mm().
//
// Flat triangles. Along a triangle's side the field bends where the side passes from one element to the next, or
// everywhere if the field is smooth. If it bends at one place, one of the points at a quarter, a half and three quarters
// of the side shows at least three quarters of the largest distance from the straight line; a smooth side is farthest
// near its middle. Twice the distance at these points is allowed, for sides that pass through several elements.
namespace octotomy::verify {

/// The point that displacements u move to p: x = p - u(x), repeated until x no longer changes. None if the
/// iteration does not converge.
template <typename Motion>
std::optional<glm::dvec3> origin_under(const Motion& motion, const glm::dvec3& p_mm,
                                       const glm::dvec3& guess_mm) {
  constexpr int most_steps = 200;
  glm::dvec3 x = guess_mm;
  for (int step = 0; step < most_steps; ++step) {
    const glm::dvec3 next = p_mm - motion.displacement_mm(x);
    const double moved_mm = glm::distance(next, x);
    x = next;
    if (moved_mm <= rounded_mm(p_mm)) return x;
  }
  return std::nullopt;
}

/// The largest distance between triangles that stay flat between moved points and the moved surface. It is
/// measured at points that are moved back.
template <typename Motion>
double bent_mm(const brep::Triangles& still, const Motion& motion) {
  constexpr double bends = 2.0;
  constexpr std::array<std::array<double, 3>, 10> places{{{0.75, 0.25, 0.0},
                                                          {0.5, 0.5, 0.0},
                                                          {0.25, 0.75, 0.0},
                                                          {0.0, 0.75, 0.25},
                                                          {0.0, 0.5, 0.5},
                                                          {0.0, 0.25, 0.75},
                                                          {0.25, 0.0, 0.75},
                                                          {0.5, 0.0, 0.5},
                                                          {0.75, 0.0, 0.25},
                                                          {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}}};
  std::vector<glm::dvec3> moved_mm(still.points_mm.size());
  tbb::parallel_for(std::size_t{0}, moved_mm.size(), [&](std::size_t i) {
    moved_mm[i] = still.points_mm[i] + motion.displacement_mm(still.points_mm[i]);
  });
  std::vector<double> off_mm(still.faces.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, off_mm.size(), [&](std::size_t face) {
    const auto& [a, b, c] = still.faces[face];
    for (const auto& [u, v, w] : places) {
      const glm::dvec3 here = u * still.points_mm[a] + v * still.points_mm[b] + w * still.points_mm[c];
      const glm::dvec3 there = u * moved_mm[a] + v * moved_mm[b] + w * moved_mm[c];
      if (glm::distance(here + motion.displacement_mm(here), there) <= rounded_mm(there)) continue;
      if (const auto origin = motion.origin_mm(there, here))
        off_mm[face] = std::max(off_mm[face], glm::distance(*origin, here));
    }
  });
  return off_mm.empty() ? 0.0 : bends * *std::max_element(off_mm.begin(), off_mm.end());
}

/// The expected surface of an object whose points move. `roundings`: number of roundings by which the
/// coordinates of two correct programs may differ.
template <typename Motion>
ReshapedSurface surface_moved(const brep::Triangles& still, const Motion& motion, double roundings,
                              const std::string& formula) {
  brep::Triangles moved = still;
  tbb::parallel_for(std::size_t{0}, moved.points_mm.size(),
                    [&](std::size_t i) { moved.points_mm[i] += motion.displacement_mm(still.points_mm[i]); });
  double farthest_mm = 1.0;
  for (const glm::dvec3& p_mm : moved.points_mm) farthest_mm = std::max(farthest_mm, glm::length(p_mm));
  return {TriangleGrid(std::move(moved)), roundings * std::numeric_limits<double>::epsilon() * farthest_mm,
          formula};
}

/// A witness of a moved object: at a point, the still object's witness at the origin of the point, loosened
/// by bent_mm(). Any answer is allowed where a point has no origin. Precondition: `still` is not empty.
template <typename Motion>
Witness witness_of_moved_points(Witness still, const brep::Triangles& still_surface,
                                std::shared_ptr<const Motion> motion) {
  const double off_mm = bent_mm(still_surface, *motion);
  return Witness([still = std::move(still), motion = std::move(motion), off_mm](
                     const glm::dvec3& p_mm, double slack_mm, ReadingNeeds asked) -> Reading {
    const auto origin = motion->origin_mm(p_mm);
    if (!origin) return {on_surface, on_surface, 2};
    return still(*origin, slack_mm + off_mm, asked);
  });
}

}  // namespace octotomy::verify
