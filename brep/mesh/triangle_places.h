// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// A triangle as the sorted positions of its corners: independent of point numbers, first corner and winding.
using Places = std::array<std::array<double, 3>, 3>;

inline Places places_of(const Triangles& triangles, const std::array<std::uint32_t, 3>& face) {
  Places places;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3& p = triangles.points_mm[face[k]];
    places[k] = {p.x, p.y, p.z};
  }
  std::sort(places.begin(), places.end());
  return places;
}

}  // namespace octotomy::brep
