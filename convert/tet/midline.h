// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "convert/tet/tetrahedra.h"

namespace octotomy::convert {

/// The nodes of the surface along a plane, ascending: nodes on the plane, and the nearer end of each side of
/// a surface triangle that the plane crosses, of equal ones the lower number. The normal may have any length.
/// Throws std::invalid_argument if its length is zero. Cost: that of surface_faces().
std::vector<std::uint32_t> midline_nodes(const Tetrahedra& tetrahedra, const glm::dvec3& point_mm,
                                         const glm::dvec3& normal);

}  // namespace octotomy::convert
