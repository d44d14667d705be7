// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh.h"

namespace octotomy::brep {

/// Triangles as files and generators have them: nothing is promised of their connection.
struct Triangles {
  std::vector<glm::dvec3> points_mm;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// The mesh of these triangles. Throws std::runtime_error naming the first triangle that refers to no point,
/// repeats a point, or cannot be joined to the others without an edge of more than two triangles or of two
/// that run along it the same way.
Mesh mesh_of(const Triangles& triangles);
Triangles triangles_of(const Mesh& mesh);

}  // namespace octotomy::brep
