// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "convert/deck/deck.h"

namespace octotomy::convert {

/// A deck of ten-node tetrahedra.
struct SecondOrder {
  Tetrahedra tetrahedra;
  DeckOptions options;
};

/// The deck with an additional node in the middle of every side; the new nodes follow the given ones.
/// Elements that share a side share its node, and sides stay straight. A set gains the middles of the surface
/// and interface triangles whose three corners it contains. If a set contains a node that is on none of these
/// triangles, it also gains the mid-side nodes of elements whose four corners it contains. So a fixed part
/// stays wholly fixed, and nothing else becomes fixed. A middle's prescribed displacement is the mean of its
/// side's ends: exact for rigid motions and linear fields. Throws std::invalid_argument if elements are of
/// second order already; voxel::Error (Resource) if there are more nodes than 32-bit numbers can name.
/// Precondition: sets and prescribed displacements fit, as write_deck() checks. Deterministic. Cost: n log n,
/// about 100 bytes an element.
SecondOrder second_order(const Tetrahedra& tetrahedra, const DeckOptions& options);

}  // namespace octotomy::convert
