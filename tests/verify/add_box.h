// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>

#include "brep/mesh/triangles.h"

namespace octotomy::tests {

/// Adds a box; inside out, it is a cavity.
inline void add_box(brep::Triangles& mesh, const glm::dvec3& low, const glm::dvec3& high,
                    bool is_cavity = false) {
  const auto first = static_cast<std::uint32_t>(mesh.points_mm.size());
  for (int corner = 0; corner < 8; ++corner)
    mesh.points_mm.emplace_back(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                                corner & 4 ? high.z : low.z);
  constexpr std::array<std::array<std::uint32_t, 4>, 6> sides{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : sides) {
    std::array<std::array<std::uint32_t, 3>, 2> two{{{a, b, c}, {a, c, d}}};
    for (auto& face : two) {
      if (is_cavity) std::swap(face[1], face[2]);
      for (std::uint32_t& corner : face) corner += first;
      mesh.faces.push_back(face);
    }
  }
}

}  // namespace octotomy::tests
