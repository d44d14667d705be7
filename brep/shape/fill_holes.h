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
  /// Triangles over points of the mesh, with the winding of the surface. Empty if none close the hole without
  /// an edge that the mesh already has, or if the border is longer than allowed.
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// The holes of a mesh, in order of their lowest edge. Borders of up to 128 sides are closed by the triangles
/// of least sharpness and area. For borders of up to 1024 sides, only triangles of the border's Delaunay
/// tetrahedra are searched. If the search finds none, and for longer borders, corners are cut off first, in
/// order of the third side's length; the triangles may then be sharper than necessary or meet the surface.
/// Cost: n log n in a border's sides, plus the search, which is at worst cubic in the sides passed to it.
std::vector<Hole> holes(const Mesh& mesh, const std::optional<double>& longest_mm);

}  // namespace octotomy::brep
