// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/kuhn_cells.h"

#include <algorithm>
#include <iterator>
#include <tbb/blocked_range.h>
#include <utility>

namespace octotomy::brep {
namespace {

/// A tetrahedron of a cell: its corners, positively oriented.
using Tetrahedron = std::array<int, 4>;
constexpr std::array<Tetrahedron, 6> tetrahedra = {
    {{0, 1, 3, 7}, {0, 5, 1, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 6, 4, 7}}};

LatticeEdge edge_between(const LatticePoint& cell, int p, int q) {
  assert(((p & q) == p || (p & q) == q) && p != q);
  const int low = p & q;  // equals p or q, because the tetrahedra's edges only ascend
  return {cell + corner_place(low), (p | q) ^ low};
}

}  // namespace

std::vector<std::uint64_t> points_about(const std::vector<std::uint64_t>& lowest, int width) {
  assert(std::is_sorted(lowest.begin(), lowest.end()));
  std::vector<std::uint64_t> points = lowest, moved, both;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint64_t step = std::uint64_t{1} << axis * side_bits;
    for (int cell = 0; cell < width; ++cell) {
      moved = points;
      for (std::uint64_t& key : moved) key += step;
      both.clear();
      std::set_union(points.begin(), points.end(), moved.begin(), moved.end(), std::back_inserter(both));
      std::swap(points, both);
    }
  }
  return points;
}

void add_triangles(const LatticePoint& cell, const std::array<double, 8>& values,
                   std::vector<EdgeTriangle>& triangles) {
  for (const Tetrahedron& t : tetrahedra) {
    // Moves the inside corners first by an even permutation, so that the tetrahedron stays positively
    // oriented.
    std::array<int, 4> in_order{};
    int inside = 0, outside = 4;
    for (const int corner : t)
      in_order[static_cast<std::size_t>(values[static_cast<std::size_t>(corner)] < 0.0 ? inside++
                                                                                       : --outside)] = corner;
    if (inside == 0 || inside == 4) continue;
    const auto place_in = [&](int corner) { return std::find(t.begin(), t.end(), corner) - t.begin(); };
    int inversions = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) inversions += place_in(in_order[i]) > place_in(in_order[j]);
    auto [a, b, c, d] = in_order;
    if (inversions % 2 == 1 && inside == 3) std::swap(a, b);
    if (inversions % 2 == 1 && inside != 3) std::swap(c, d);
    const auto edge = [&](int p, int q) { return edge_between(cell, p, q); };
    if (inside == 1) {
      triangles.push_back({edge(a, b), edge(a, c), edge(a, d)});
    } else if (inside == 3) {
      triangles.push_back({edge(d, a), edge(d, b), edge(d, c)});
    } else {
      triangles.push_back({edge(a, c), edge(a, d), edge(b, d)});
      triangles.push_back({edge(a, c), edge(b, d), edge(b, c)});
    }
  }
}

}  // namespace octotomy::brep
