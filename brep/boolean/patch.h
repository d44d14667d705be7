// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Some triangles of an operand as a separate mesh.
struct Patch {
  Mesh mesh;
  std::vector<std::uint32_t> points;  ///< points of the operand, in the order of the mesh's points
};

/// Cost: linear in the points of the operand and in the faces of the patch.
inline Patch patch_of(const Triangles& operand, const std::vector<std::uint32_t>& faces) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  Triangles patch;
  std::vector<std::uint32_t> number(operand.points_mm.size(), none), points;
  for (const std::uint32_t f : faces) {
    std::array<std::uint32_t, 3> face = operand.faces[f];
    for (std::uint32_t& v : face) {
      if (number[v] == none) {
        number[v] = static_cast<std::uint32_t>(patch.points_mm.size());
        patch.points_mm.push_back(operand.points_mm[v]);
        points.push_back(v);
      }
      v = number[v];
    }
    patch.faces.push_back(face);
  }
  return {mesh_of(patch), std::move(points)};
}

}  // namespace octotomy::brep
