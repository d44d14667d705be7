// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "convert/deck.h"

namespace octotomy::convert {

/// A deck of ten-node tetrahedra.
struct SecondOrder {
  Tetrahedra tetrahedra;
  DeckOptions options;
};

/// The same deck with a node in the middle of every side, behind the given nodes; elements that share a side
/// share its node, and sides stay straight. A set takes the middles of the sides of triangles of the surface
/// and of interfaces whose three corners it holds, and one with a node that is on neither those of elements
/// whose four it holds: what is held stays held all over, and no more is. What is prescribed of a middle is
/// the mean of its side's ends: exact for rigid motions and linear fields. Throws std::invalid_argument where
/// the elements are of second order already. Precondition: sets and prescribed displacements fit, as
/// write_deck() checks. Deterministic. Cost: n log n, about 100 bytes an element.
SecondOrder second_order(const Tetrahedra& tetrahedra, const DeckOptions& options);

}  // namespace octotomy::convert
