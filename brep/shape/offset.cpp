// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 halve blocks of the lattice, keeping those that the surface may pass; 2 find the offset distance at their
// corners; 3 find the surface on each tetrahedron's edge whose ends lie on either side; 4 join those points.
#include "brep/shape/offset.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace octotomy::brep {
namespace {

constexpr int side_bits = 20;
constexpr std::size_t most_blocks = std::size_t{1} << 20;  // of eight cells each
constexpr double nearest_end = 0x1p-10;  // of an edge: points nearer to its end could be one with others

using Place = glm::ivec3;

/// A place as a number that sorts by z, y, x.
std::uint64_t key_of(const Place& p) {
  assert(glm::all(glm::greaterThanEqual(p, Place(0))) && glm::all(glm::lessThan(p, Place(1 << side_bits))));
  return (static_cast<std::uint64_t>(p.z) << 2 * side_bits) | (static_cast<std::uint64_t>(p.y) << side_bits) |
         static_cast<std::uint64_t>(p.x);
}
Place place_of(std::uint64_t key) {
  constexpr std::uint64_t mask = (std::uint64_t{1} << side_bits) - 1;
  return {static_cast<int>(key & mask), static_cast<int>(key >> side_bits & mask),
          static_cast<int>(key >> 2 * side_bits)};
}

/// Bit 0 is x: one of a cell's corners, or the way along an edge from its lower end.
Place corner_place(int corner) {
  assert(corner >= 0 && corner < 8);
  return {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
}

/// Signed distance to the offset surface, negative within.
class Field {
 public:
  Field(const Solid& solid, double by_mm) : tree_(solid.tree()), by_mm_(by_mm) {}

  std::vector<double> at(const std::vector<glm::dvec3>& points_mm) const {
    std::vector<double> values = tree_.distances_mm(points_mm);
    const std::vector<std::uint8_t> inside = tree_.inside(points_mm);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = (inside[i] ? -values[i] : values[i]) - by_mm_;
    return values;
  }

 private:
  const SurfaceTree& tree_;
  double by_mm_;
};

/// A cube of cells about the offset solid, a power of two along each side.
struct Lattice {
  glm::dvec3 origin_mm{0.0};
  double cell_mm = 1.0;
  int side = 2;

  glm::dvec3 at(const Place& p) const { return origin_mm + cell_mm * glm::dvec3(p); }
};

Lattice lattice_about(const Solid& solid, const OffsetOptions& options) {
  const Size& size = solid.size();
  const double margin = std::max(options.by_mm, 0.0) + options.cell_mm;
  const glm::dvec3 extent = size.high_mm - size.low_mm + 2.0 * margin;
  const double cells = std::max({extent.x, extent.y, extent.z}) / options.cell_mm;
  if (!(cells < (1 << side_bits) - 2))
    throw std::length_error(
        "cells of " + std::to_string(options.cell_mm) + " mm are too small for a solid of " +
        std::to_string(std::max({extent.x, extent.y, extent.z})) + " mm: a side has at most 2^20 of them");
  Lattice lattice{size.low_mm - margin, options.cell_mm, 2};
  while (lattice.side < cells) lattice.side *= 2;
  return lattice;
}

/// Lower corners of the blocks of two cells a side that the surface may pass.
std::vector<std::uint64_t> blocks_near(const Field& field, const Lattice& lattice,
                                       const OffsetOptions& options) {
  std::vector<std::uint64_t> blocks = {0};
  for (int side = lattice.side; side > 2; side /= 2) {
    options.progress.at(0.0);
    std::vector<std::uint64_t> halves;
    std::vector<glm::dvec3> centres_mm;
    for (const std::uint64_t block : blocks)
      for (int corner = 0; corner < 8; ++corner) {
        const Place low = place_of(block) + side / 2 * corner_place(corner);
        halves.push_back(key_of(low));
        centres_mm.push_back(lattice.at(low) + 0.25 * side * lattice.cell_mm);
      }
    const std::vector<double> values = field.at(centres_mm);
    const double to_corner_mm = 0.25 * side * lattice.cell_mm * std::sqrt(3.0) * (1.0 + 1e-9);
    blocks.clear();
    for (std::size_t i = 0; i < halves.size(); ++i)
      if (std::abs(values[i]) <= to_corner_mm) blocks.push_back(halves[i]);
    if (blocks.size() > most_blocks)
      throw std::length_error("the offset surface passes more than 2^23 cells of " +
                              std::to_string(lattice.cell_mm) + " mm: take larger ones");
  }
  return blocks;
}

/// The lattice's points about blocks and the field there.
struct Corners {
  std::vector<std::uint64_t> keys;  // ascending
  std::vector<double> values;

  double at(const Place& p) const {
    const auto found = std::lower_bound(keys.begin(), keys.end(), key_of(p));
    assert(found != keys.end() && *found == key_of(p));
    return values[static_cast<std::size_t>(found - keys.begin())];
  }
};

Corners corners_of(const std::vector<std::uint64_t>& blocks, const Field& field, const Lattice& lattice) {
  Corners corners;
  for (const std::uint64_t block : blocks)
    for (int i = 0; i < 27; ++i)
      corners.keys.push_back(key_of(place_of(block) + Place(i % 3, i / 3 % 3, i / 9)));
  std::sort(corners.keys.begin(), corners.keys.end());
  corners.keys.erase(std::unique(corners.keys.begin(), corners.keys.end()), corners.keys.end());
  std::vector<glm::dvec3> points_mm;
  points_mm.reserve(corners.keys.size());
  for (const std::uint64_t key : corners.keys) points_mm.push_back(lattice.at(place_of(key)));
  corners.values = field.at(points_mm);
  return corners;
}

/// An edge of a tetrahedron whose ends lie on either side of the surface.
struct Edge {
  std::uint64_t from = 0;  // key of its lower end
  int along = 0;           // corner of the cell above that end where it leads
  bool operator==(const Edge&) const = default;
  bool operator<(const Edge& other) const {
    return std::tie(from, along) < std::tie(other.from, other.along);
  }
};

/// Three edges for each triangle, outward.
using EdgeTriangle = std::array<Edge, 3>;

/// A tetrahedron of a cell: its corners, positively oriented.
using Tetrahedron = std::array<int, 4>;
constexpr std::array<Tetrahedron, 6> tetrahedra = {
    {{0, 1, 3, 7}, {0, 5, 1, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 6, 4, 7}}};

Edge edge_between(const Place& cell, int p, int q) {
  assert(((p & q) == p || (p & q) == q) && p != q);
  const int low = p & q;  // one of the two, as the tetrahedra's edges only ascend
  return {key_of(cell + corner_place(low)), (p | q) ^ low};
}

void add_triangles(const Place& cell, const std::array<double, 8>& values,
                   std::vector<EdgeTriangle>& triangles) {
  for (const Tetrahedron& t : tetrahedra) {
    // The inside corners first, by an even exchange, so that the tetrahedron stays positive.
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

std::vector<EdgeTriangle> triangles_in(const std::vector<std::uint64_t>& blocks, const Corners& corners) {
  std::vector<EdgeTriangle> triangles;
  for (const std::uint64_t block : blocks)
    for (int i = 0; i < 8; ++i) {
      const Place cell = place_of(block) + corner_place(i);
      std::array<double, 8> values{};
      for (int k = 0; k < 8; ++k) values[static_cast<std::size_t>(k)] = corners.at(cell + corner_place(k));
      add_triangles(cell, values, triangles);
    }
  return triangles;
}

/// A root between two places of either sign, by regula falsi; an end that stays has its value halved, so that
/// it moves too (Illinois).
struct Root {
  double low = 0.0, high = 1.0, at_low = 0.0, at_high = 0.0, share = 0.5;
  int kept = 0;  // the end that stayed: -1 low, 1 high

  void guess() {
    assert((at_low < 0.0) != (at_high < 0.0));
    share = std::clamp(low + (high - low) * at_low / (at_low - at_high), low, high);
  }
  void learn(double value) {
    if ((value < 0.0) == (at_low < 0.0)) {
      low = share;
      at_low = value;
      if (kept == 1) at_high *= 0.5;
      kept = 1;
    } else {
      high = share;
      at_high = value;
      if (kept == -1) at_low *= 0.5;
      kept = -1;
    }
  }
};

/// Where the surface passes each edge, within a thousandth of a cell.
std::vector<glm::dvec3> points_on(const std::vector<Edge>& edges, const Corners& corners, const Field& field,
                                  const Lattice& lattice) {
  std::vector<Root> roots(edges.size());
  std::vector<std::size_t> open(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Place from = place_of(edges[i].from);
    roots[i].at_low = corners.at(from);
    roots[i].at_high = corners.at(from + corner_place(edges[i].along));
    roots[i].guess();
    open[i] = i;
  }
  const auto place = [&](std::size_t i) {
    return lattice.at(place_of(edges[i].from)) +
           roots[i].share * lattice.cell_mm * glm::dvec3(corner_place(edges[i].along));
  };
  // Twenty rounds would do by halving alone, were it ever needed.
  for (int round = 0; round < 20 && !open.empty(); ++round) {
    std::vector<glm::dvec3> tried_mm;
    tried_mm.reserve(open.size());
    for (const std::size_t i : open) tried_mm.push_back(place(i));
    const std::vector<double> values = field.at(tried_mm);
    assert(values.size() == open.size());
    std::vector<std::size_t> still_open;
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (std::abs(values[k]) <= 0x1p-11 * lattice.cell_mm) continue;
      Root& root = roots[open[k]];
      root.learn(values[k]);
      root.guess();
      still_open.push_back(open[k]);
    }
    open = std::move(still_open);
  }
  std::vector<glm::dvec3> points_mm;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    roots[i].share = std::clamp(roots[i].share, nearest_end, 1.0 - nearest_end);
    points_mm.push_back(place(i));
  }
  return points_mm;
}

void check(const Solid& solid, const OffsetOptions& options) {
  if (solid.empty()) throw std::invalid_argument("a surface without triangles has no offset");
  if (!std::isfinite(options.by_mm)) throw std::invalid_argument("an offset is by a finite length");
  if (!std::isfinite(options.cell_mm) || options.cell_mm <= 0.0)
    throw std::invalid_argument("an offset's cells have an edge above 0 mm");
}

}  // namespace

Solid offset(const Solid& solid, const OffsetOptions& options) {
  check(solid, options);
  const Lattice lattice = lattice_about(solid, options);
  const Field field(solid, options.by_mm);
  const std::vector<std::uint64_t> blocks = blocks_near(field, lattice, options);
  options.progress.at(0.25);
  const Corners corners = corners_of(blocks, field, lattice);
  options.progress.at(0.5);
  const std::vector<EdgeTriangle> triangles = triangles_in(blocks, corners);
  std::vector<Edge> edges;
  for (const EdgeTriangle& triangle : triangles) edges.insert(edges.end(), triangle.begin(), triangle.end());
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  options.progress.at(0.6);
  Triangles surface;
  surface.points_mm = points_on(edges, corners, field, lattice);
  const auto number = [&](const Edge& edge) {
    assert(std::binary_search(edges.begin(), edges.end(), edge));
    return static_cast<std::uint32_t>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin());
  };
  for (const EdgeTriangle& t : triangles) surface.faces.push_back({number(t[0]), number(t[1]), number(t[2])});
  options.progress.at(1.0);
  return trusted_solid(std::move(surface), Proof::Construction);
}

}  // namespace octotomy::brep
