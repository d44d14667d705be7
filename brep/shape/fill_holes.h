// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// A border of a mesh, and triangles that close it without further points.
struct Hole {
  std::vector<std::uint32_t> border;  ///< points of the mesh, the surface on their right
  double perimeter_mm = 0.0;
  glm::dvec3 centre_mm{0.0};  ///< mean of the points
  /// Of points of the mesh, winding as the surface does; empty where none close it without an edge that the
  /// mesh has already, or the border is longer than allowed.
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// The holes of a mesh, by their lowest edge. Cost: a border's length cubed at worst.
std::vector<Hole> holes(const Mesh& mesh, const std::optional<double>& longest_mm);

}  // namespace octotomy::brep
