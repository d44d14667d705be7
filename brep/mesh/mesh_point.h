// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

/// Converts a mesh's point to GLM.
inline glm::dvec3 glm_of(const Mesh::Point& p) {
  return {p[0], p[1], p[2]};
}

}  // namespace octotomy::brep
