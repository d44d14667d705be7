// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "convert/tetrahedra.h"

namespace octotomy::convert {

/// Two regions by their numbers.
using RegionPair = std::pair<std::uint32_t, std::uint32_t>;

/// The same elements, regions apart: each region has nodes of its own where it shared them with others, in
/// the same places, so that contact may open and slide between them. A node stays its lowest region's; copies
/// stand behind all nodes, by node and region; elements keep their numbers, so that faces found before stand.
/// Boundary nodes take in both sides of what were interfaces. Throws std::invalid_argument where elements are
/// of second order already: part regions before. Cost: linear.
Tetrahedra separate_regions(const Tetrahedra& tetrahedra);

/// The same of given pairs alone, as lips slide on each other that both go on in the cheek: where a third
/// region shares a node with both, the slit ends and they share it, too.
Tetrahedra separate_regions(const Tetrahedra& tetrahedra, const std::vector<RegionPair>& apart);

}  // namespace octotomy::convert
