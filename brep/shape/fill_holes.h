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

/// The holes of a mesh, by their lowest edge. Borders of up to 128 sides are closed by the triangles of least
/// sharpness and area. Of longer ones up to 1024 sides those of the border's Delaunay tetrahedra are
/// searched. Where that finds none, and on still longer borders, corners are cut off before such a search,
/// those with the shortest third side first; the triangles may then be sharper than need be or meet the
/// surface. Cost: n log n in a border's sides, and the search, cubic in those that it is given at worst.
std::vector<Hole> holes(const Mesh& mesh, const std::optional<double>& longest_mm);

}  // namespace octotomy::brep
