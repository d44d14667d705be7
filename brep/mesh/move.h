// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

class Solid;

/// The surface moved by a rigid motion, LPS to LPS. Throws std::invalid_argument if the matrix is not rigid.
Mesh moved(const Mesh& mesh, const glm::dmat4& moved_from_still);
Triangles moved(const Triangles& triangles, const glm::dmat4& moved_from_still);

/// The surface under an affine map that scales or shears, LPS to LPS; its triangles still wind outward. Throws
/// std::invalid_argument if an entry is not finite, if the last row is not 0 0 0 1, if the determinant is not
/// positive (mirrored() reflects), or if a point of the image is not finite. Cost: linear.
Solid deformed(const Solid& solid, const glm::dmat4& deformed_from_still);

}  // namespace octotomy::brep
