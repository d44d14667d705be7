// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <vector>

// A lattice of cells, each of six tetrahedra after Kuhn, and the surface between lattice points of different
// sign. Each triangle lies within one tetrahedron, and two in the same tetrahedron share a side. So triangles
// do not intersect if their corners are inside the tetrahedra's edges.
namespace octotomy::brep {

using LatticePoint = glm::ivec3;
constexpr int side_bits = 20;  ///< bits of each coordinate, 0 .. 2^20 - 1

/// Least distance of a point from an end of its edge, as a share of the edge: nearer points could coincide
/// with others.
constexpr double nearest_end = 0x1p-10;

/// A lattice position as a number that sorts by z, y, x.
inline std::uint64_t key_of(const LatticePoint& p) {
  assert(glm::all(glm::greaterThanEqual(p, LatticePoint(0))) &&
         glm::all(glm::lessThan(p, LatticePoint(1 << side_bits))));
  return (static_cast<std::uint64_t>(p.z) << 2 * side_bits) | (static_cast<std::uint64_t>(p.y) << side_bits) |
         static_cast<std::uint64_t>(p.x);
}
inline LatticePoint place_of(std::uint64_t key) {
  constexpr std::uint64_t mask = (std::uint64_t{1} << side_bits) - 1;
  return {static_cast<int>(key & mask), static_cast<int>(key >> side_bits & mask),
          static_cast<int>(key >> 2 * side_bits)};
}

/// The offset of a cell's corner, or of an edge from its lower to its upper end. Bit 0 is x.
inline LatticePoint corner_place(int corner) {
  assert(corner >= 0 && corner < 8);
  return {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
}

/// The lattice points of cubes of `width` cells with these lowest points, each once; both lists ascend. Cost:
/// linear, because a list that is shifted along an axis stays sorted.
std::vector<std::uint64_t> points_about(const std::vector<std::uint64_t>& lowest, int width);

/// Calls append(source, items) for each source, in parallel. Returns all items in the order of the sources.
template <typename Item, typename Source, typename Append>
std::vector<Item> appended(const std::vector<Source>& sources, const Append& append) {
  constexpr std::size_t part = 1024;
  std::vector<std::vector<Item>> parts((sources.size() + part - 1) / part);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
    for (std::size_t i = p * part; i < std::min((p + 1) * part, sources.size()); ++i)
      append(sources[i], parts[p]);
  });
  std::size_t count = 0;
  for (const std::vector<Item>& items : parts) count += items.size();
  std::vector<Item> all;
  all.reserve(count);
  for (std::vector<Item>& items : parts) {
    all.insert(all.end(), items.begin(), items.end());
    items = {};
  }
  return all;
}

/// An edge of a tetrahedron whose ends lie on different sides of the surface; sorts by its lower end. Packed
/// in one number, because a surface has millions of them.
class LatticeEdge {
 public:
  LatticeEdge() = default;
  /// The edge starts at `from`, the lowest corner of a cell, and ends at corner `along` of this cell.
  LatticeEdge(const LatticePoint& from, int along)
      : packed_(key_of(from) << 3 | static_cast<std::uint64_t>(along)) {
    assert(along > 0 && along < 8);
  }
  std::uint64_t from() const { return packed_ >> 3; }  ///< key of its lower end
  int along() const { return static_cast<int>(packed_ & 7); }
  auto operator<=>(const LatticeEdge&) const = default;

 private:
  std::uint64_t packed_ = 0;
};

/// A triangle by the three edges on which its corners lie, oriented outward.
using EdgeTriangle = std::array<LatticeEdge, 3>;

/// Appends the triangles of the surface in the cell with this lower corner. Values below 0 are inside.
void add_triangles(const LatticePoint& cell, const std::array<double, 8>& values,
                   std::vector<EdgeTriangle>& triangles);

/// The edges of triangles, each once, ascending.
template <typename Edge>
std::vector<Edge> edges_of(const std::vector<std::array<Edge, 3>>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (const auto& triangle : triangles) edges.insert(edges.end(), triangle.begin(), triangle.end());
  tbb::parallel_sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// The triangles by the indices of their edges in the list of edges_of().
template <typename Edge>
std::vector<std::array<std::uint32_t, 3>> numbered(const std::vector<std::array<Edge, 3>>& triangles,
                                                   const std::vector<Edge>& edges) {
  std::vector<std::array<std::uint32_t, 3>> faces(triangles.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, faces.size(), 1024), [&](const auto& range) {
    for (std::size_t f = range.begin(); f != range.end(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = std::lower_bound(edges.begin(), edges.end(), triangles[f][k]);
        assert(found != edges.end() && *found == triangles[f][k]);
        faces[f][k] = static_cast<std::uint32_t>(found - edges.begin());
      }
  });
  return faces;
}

}  // namespace octotomy::brep
