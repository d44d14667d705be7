// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// The mesh under a rigid motion, LPS to LPS. Throws std::invalid_argument where the matrix is not rigid.
Mesh moved(const Mesh& mesh, const glm::dmat4& moved_from_still);

}  // namespace octotomy::brep
