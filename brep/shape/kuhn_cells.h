// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <glm/glm.hpp>
#include <tuple>
#include <vector>

// A lattice of cells, each of six tetrahedra after Kuhn, and the surface between lattice points of either
// sign. Each triangle lies in a tetrahedron of its own, so that none intersect as long as their corners stay
// inside their edges.
namespace octotomy::brep {

using Place = glm::ivec3;
constexpr int side_bits = 20;  ///< of a place's coordinates, 0 .. 2^20 - 1

/// Of an edge: points nearer to its end could be one with others.
constexpr double nearest_end = 0x1p-10;

/// A place as a number that sorts by z, y, x.
inline std::uint64_t key_of(const Place& p) {
  assert(glm::all(glm::greaterThanEqual(p, Place(0))) && glm::all(glm::lessThan(p, Place(1 << side_bits))));
  return (static_cast<std::uint64_t>(p.z) << 2 * side_bits) | (static_cast<std::uint64_t>(p.y) << side_bits) |
         static_cast<std::uint64_t>(p.x);
}
inline Place place_of(std::uint64_t key) {
  constexpr std::uint64_t mask = (std::uint64_t{1} << side_bits) - 1;
  return {static_cast<int>(key & mask), static_cast<int>(key >> side_bits & mask),
          static_cast<int>(key >> 2 * side_bits)};
}

/// Bit 0 is x: one of a cell's corners, or the way along an edge from its lower end.
inline Place corner_place(int corner) {
  assert(corner >= 0 && corner < 8);
  return {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
}

/// An edge of a tetrahedron whose ends lie on either side of the surface.
struct LatticeEdge {
  std::uint64_t from = 0;  // key of its lower end
  int along = 0;           // corner of the cell above that end where it leads
  bool operator==(const LatticeEdge&) const = default;
  bool operator<(const LatticeEdge& other) const {
    return std::tie(from, along) < std::tie(other.from, other.along);
  }
};

/// Three edges for each triangle, outward.
using EdgeTriangle = std::array<LatticeEdge, 3>;

/// Appends the triangles of the surface in the cell with this lower corner. Values below 0 are inside.
void add_triangles(const Place& cell, const std::array<double, 8>& values,
                   std::vector<EdgeTriangle>& triangles);

/// The edges of the triangles, each once, ascending.
std::vector<LatticeEdge> edges_of(const std::vector<EdgeTriangle>& triangles);

/// The triangles by the places of their edges in the list that edges_of() made.
std::vector<std::array<std::uint32_t, 3>> numbered(const std::vector<EdgeTriangle>& triangles,
                                                   const std::vector<LatticeEdge>& edges);

}  // namespace octotomy::brep
