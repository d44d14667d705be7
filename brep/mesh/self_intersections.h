// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "brep/mesh/morton_tree.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Pairs of triangles of one surface that meet outside a shared corner or side. Corners with equal coordinates
/// are shared, so sheets may touch at a point or along an edge. If they cross there, one pair is counted.
struct SelfIntersections {
  std::size_t count = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> first;  ///< lower triangle first, ascending
};

/// The surface to search. Precondition: all points are finite.
struct IntersectionSearch {
  const Triangles& triangles;
  const MortonTree& tree;                       ///< tree over all triangles
  const std::vector<std::uint8_t>& degenerate;  ///< marks the triangles without area, which are excluded
  std::size_t most_first = 100;                 ///< largest number of pairs to store in `first`
};

/// Finds the pairs exactly, including triangles with the same points. The result is the same on any number of
/// threads. Cost: n log n, and constant for each pair of triangles whose boxes overlap. Among 64 or more
/// triangles around one point, only pairs that lie in nearly the same direction from the point are tested.
SelfIntersections self_intersections(const IntersectionSearch& search);

}  // namespace octotomy::brep
