// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <stop_token>
#include <vector>

#include "convert/tetrahedra.h"

namespace octotomy::convert {

struct ImproveOptions {
  double min_dihedral_deg = 8.0;  ///< what every element is to have, 0..60; better ones are left alone
  /// How far each node of the surface may move, in the order of `boundary_nodes`; empty: they stay, to the
  /// bit.
  std::vector<double> surface_play_mm{};
  int rounds = 10;         ///< over all elements that fall short, at least 1
  std::stop_token stop{};  ///< ends it between rounds
};

/// Moves nodes so that the flattest elements get larger smallest dihedral angles. No element's
/// neighbourhood gets worse by a move: the smallest angle of the whole never falls and no volume becomes
/// zero or negative that was not. The elements, their order and their nodes' numbers stay. What cannot be
/// mended by moving single nodes stays as it is: ask quality(). Throws std::invalid_argument where an option
/// is out of its range. Deterministic. Cost: linear, and some 50 us a flat element and round.
/// Source: after Freitag and Ollivier-Gooch, "Tetrahedral mesh improvement using swapping and smoothing",
/// IJNME 40, 1997; the search is by steps in fixed directions, as the smallest angle has no gradient.
void improve(Tetrahedra& tetrahedra, const ImproveOptions& options);

}  // namespace octotomy::convert
