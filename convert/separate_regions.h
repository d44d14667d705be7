// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "convert/tetrahedra.h"

namespace octotomy::convert {

/// The same elements, regions apart: each region has nodes of its own where it shared them with others, in
/// the same places, so that contact may open and slide between them. A node stays its lowest region's; copies
/// stand behind all nodes, by node and region; elements keep their numbers, so that faces found before stand.
/// Boundary nodes take in both sides of what were interfaces. Throws std::invalid_argument where elements are
/// of second order already: part regions before. Cost: linear.
Tetrahedra separate_regions(const Tetrahedra& tetrahedra);

}  // namespace octotomy::convert
