// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "brep/mesh/morton_tree.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Pairs of triangles of one surface that meet elsewhere than in a shared corner or side.
struct SelfIntersections {
  std::size_t count = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> first;  ///< lower triangle first, ascending
};

/// A surface to find them in. Precondition: all points are finite.
struct IntersectionSearch {
  const Triangles& triangles;
  const MortonTree& tree;                       ///< of all triangles
  const std::vector<std::uint8_t>& degenerate;  ///< marks the triangles without area, which are left out
  std::size_t most_first = 100;                 ///< most pairs that are kept beside their count
};

/// Finds the pairs exactly, of triangles with the same points too. The same on any number of threads. Cost:
/// n log n and constant for each pair of triangles whose boxes overlap. Of 64 and more triangles about one
/// point only those pairs count that the point sees in about the same direction.
SelfIntersections self_intersections(const IntersectionSearch& search);

}  // namespace octotomy::brep
