// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "convert/tetrahedra.h"

namespace octotomy::convert {

/// The nodes of the surface along a plane, ascending: of each side of a surface triangle that the plane
/// crosses, the nearer end, the lower number of equals; and the nodes on it. The normal need not be of unit
/// length. Throws std::invalid_argument where it has none. Cost: that of surface_faces().
std::vector<std::uint32_t> midline_nodes(const Tetrahedra& tetrahedra, const glm::dvec3& point_mm,
                                         const glm::dvec3& normal);

}  // namespace octotomy::convert
