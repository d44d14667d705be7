// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "convert/tet/tetrahedra.h"

namespace octotomy::convert {

/// Two regions by their numbers.
using RegionPair = std::pair<std::uint32_t, std::uint32_t>;

/// The same elements with separate regions: each region has its own nodes at the places of shared nodes, so
/// contact can open and slide between regions. A node stays with its lowest region. Copies follow all nodes,
/// by node and region. Elements keep their numbers, so faces found before stay valid. Boundary nodes include
/// both sides of the former interfaces. Throws std::invalid_argument if elements are of second order:
/// separate regions first; voxel::Error (Resource) if there are more nodes than 32-bit numbers can name.
/// Cost: linear.
Tetrahedra separate_regions(const Tetrahedra& tetrahedra);

/// Separates only the given pairs. If a third region shares a node with both of a pair, the slit ends there
/// and all three share the node: lips slide on each other, and both continue into the cheek.
Tetrahedra separate_regions(const Tetrahedra& tetrahedra, const std::vector<RegionPair>& apart);

}  // namespace octotomy::convert
