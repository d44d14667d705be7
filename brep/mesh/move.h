// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The surface moved by a rigid motion, LPS to LPS. Throws std::invalid_argument if the matrix is not rigid.
Mesh moved(const Mesh& mesh, const glm::dmat4& moved_from_still);
Triangles moved(const Triangles& triangles, const glm::dmat4& moved_from_still);

}  // namespace octotomy::brep
