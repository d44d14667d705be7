// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "convert/tet/tetrahedra.h"

namespace octotomy::tests {

/// A cube of 1 mm with its lowest corner at `corner_mm`, cut in five: four corners, and in its middle an
/// element whose four nodes are also on the surface.
inline convert::Tetrahedra cube_in_five(const glm::dvec3& corner_mm = glm::dvec3(0.0)) {
  convert::Tetrahedra t;
  for (int c = 0; c < 8; ++c) t.nodes_mm.push_back(corner_mm + glm::dvec3(c & 1, (c >> 1) & 1, c >> 2));
  t.tets = {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 1, 4, 7}, {6, 2, 7, 4}, {1, 2, 4, 7}};
  t.boundary_nodes = convert::boundary_nodes(t.tets);
  return t;
}

}  // namespace octotomy::tests
