// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "brep/mesh/mesh.h"

namespace octotomy::brep {

struct OrientedBox {
  glm::dvec3 centre_mm{0.0};
  std::array<glm::dvec3, 3> axes;  ///< unit vectors, perpendicular, right-handed; the first along the longest
                                   ///< edge
  glm::dvec3 edges_mm{0.0};        ///< along the axes, falling
  double volume_mm3() const { return edges_mm.x * edges_mm.y * edges_mm.z; }
};

/// A box of nearly least volume around the points of a mesh's triangles, LPS. The largest component of each
/// of the first two axes is positive; the third axis makes them right-handed. Throws std::invalid_argument if
/// there are no triangles. Cost: n log n for the hull, then a search over at most 4000 of its points.
/// Source: Chang, Gorissen and Melchior, "Fast oriented bounding box optimization on the rotation group SO(3,
/// R)", TOG 30(5), 2011, as implemented in CGAL, with a fixed seed.
OrientedBox oriented_box(const Mesh& mesh);

}  // namespace octotomy::brep
