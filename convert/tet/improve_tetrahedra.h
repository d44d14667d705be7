// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "convert/tet/tetrahedra.h"
#include "voxel/space/progress.h"

namespace octotomy::convert {

struct ImproveOptions {
  double min_dihedral_deg = 8.0;  ///< goal for every element, 0..60; elements that reach it stay as they are
  /// How far each node of the surface may move, in the order of `boundary_nodes`. Empty: they stay, to the
  /// bit. With `keeps_flat` nodes of flat faces of the surface and between regions stay in their planes,
  /// nodes of straight edges stay on their lines, and corners do not move.
  std::vector<double> surface_play_mm{};
  bool keeps_flat = true;  ///< nodes of flat faces and straight edges stay in and on them
  int rounds = 10;         ///< largest number of rounds over all elements below the goal, at least 1
  /// Stops after a round if the remaining rounds cannot mend every element, assuming that a round mends at
  /// most half of the remaining elements, or the last round's share if that is larger. Not allowed with
  /// `surface_play_mm`, which counts from the nodes' positions at the beginning of a call.
  bool all_or_nothing = false;
  voxel::Progress progress{};  ///< of the rounds
};

/// Moves nodes so that the smallest dihedral angles of the flattest elements grow. A move never lowers the
/// smallest angle about its node, and makes no volume zero or negative. Elements, their order and their
/// nodes' numbers stay. Elements that no move of a single node can improve stay too: see quality(). Returns
/// the rounds left if it stopped early, so that another call can continue; otherwise 0. Throws
/// std::invalid_argument if an option is out of range; voxel::Stopped. Deterministic. Cost: linear, and about
/// 40 us a flat element and round. Source: after Freitag and Ollivier-Gooch, "Tetrahedral mesh improvement
/// using swapping and smoothing", IJNME 40, 1997. Departure: the search takes steps in fixed directions, as
/// the smallest angle has no gradient.
int improve(Tetrahedra& tetrahedra, const ImproveOptions& options);

}  // namespace octotomy::convert
