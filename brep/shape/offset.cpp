// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 halve blocks of the lattice and keep those that the surface may cross; 2 compute the offset distance at
// their corners; 3 find the surface on each tetrahedron's edge whose ends lie on different sides; 4 join
// those points.
#include "brep/shape/offset.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <utility>
#include <vector>

#include "brep/mesh/sample_surface.h"
#include "brep/shape/kuhn_cells.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t most_blocks = std::size_t{1} << 20;  // blocks of eight cells each

/// Signed distance to the offset surface, negative inside.
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

/// A cube of cells around the offset solid; the number of cells a side is a power of two.
struct Lattice {
  glm::dvec3 origin_mm{0.0};
  double cell_mm = 1.0;
  int side = 2;

  glm::dvec3 at(const Place& p) const { return origin_mm + cell_mm * glm::dvec3(p); }
};

Lattice lattice_about(const Solid& solid, const OffsetOptions& options) {
  const Size& size = solid.size();
  // Shifted by irregular shares of a cell, so that planes at round coordinates do not coincide with lattice
  // planes, where a surface would consist of slivers.
  const double margin = std::max(options.by_mm, 0.0) + 2.0 * options.cell_mm;
  const glm::dvec3 odd_mm = options.cell_mm * glm::dvec3(0.2718281828, 0.3141592653, 0.1414213562);
  const glm::dvec3 extent = size.high_mm - size.low_mm + 2.0 * margin;
  const double cells = std::max({extent.x, extent.y, extent.z}) / options.cell_mm;
  if (!(cells < (1 << side_bits) - 2))
    throw std::length_error(
        "cells of " + std::to_string(options.cell_mm) + " mm are too small for a solid of " +
        std::to_string(std::max({extent.x, extent.y, extent.z})) + " mm: a side has at most 2^20 of them");
  Lattice lattice{size.low_mm - margin + odd_mm, options.cell_mm, 2};
  while (lattice.side < cells) lattice.side *= 2;
  return lattice;
}

/// Lower corners of the blocks of two cells a side that the surface may cross.
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

/// The lattice points of blocks, and the field there.
struct Corners {
  std::vector<std::uint64_t> keys;  // ascending
  std::vector<double> values;

  /// The index of a point in the lists. Precondition: it is in them.
  std::size_t number_of(const Place& p) const {
    const auto found = std::lower_bound(keys.begin(), keys.end(), key_of(p));
    assert(found != keys.end() && *found == key_of(p));
    return static_cast<std::size_t>(found - keys.begin());
  }
  double at(const Place& p) const { return values[number_of(p)]; }

  /// The values at a block's points, x fastest. Three points along x are adjacent in the lists.
  std::array<double, 27> of_block(const Place& low) const {
    std::array<double, 27> at_points{};
    for (int row = 0; row < 9; ++row) {
      const auto first =
          values.begin() + static_cast<std::ptrdiff_t>(number_of(low + Place(0, row % 3, row / 3)));
      std::copy_n(first, 3, at_points.begin() + 3 * row);
    }
    return at_points;
  }
};

Corners corners_of(const std::vector<std::uint64_t>& blocks, const Field& field, const Lattice& lattice) {
  std::vector<std::uint64_t> ascending = blocks;
  tbb::parallel_sort(ascending.begin(), ascending.end());
  Corners corners;
  corners.keys = points_about(ascending, 2);
  std::vector<glm::dvec3> points_mm;
  points_mm.reserve(corners.keys.size());
  for (const std::uint64_t key : corners.keys) points_mm.push_back(lattice.at(place_of(key)));
  corners.values = field.at(points_mm);
  return corners;
}

std::vector<EdgeTriangle> triangles_in(const std::vector<std::uint64_t>& blocks, const Corners& corners) {
  return appended<EdgeTriangle>(blocks, [&](const Place& low, std::vector<EdgeTriangle>& triangles) {
    const std::array<double, 27> at_points = corners.of_block(low);
    for (int i = 0; i < 8; ++i) {
      std::array<double, 8> values{};
      for (int k = 0; k < 8; ++k) {
        const Place p = corner_place(i) + corner_place(k);
        values[static_cast<std::size_t>(k)] = at_points[static_cast<std::size_t>(p.x + 3 * p.y + 9 * p.z)];
      }
      add_triangles(low + corner_place(i), values, triangles);
    }
  });
}

/// A root between two positions of different sign, by regula falsi. The value at an end that does not move is
/// halved, so that this end moves too (Illinois).
struct Root {
  double low = 0.0, high = 1.0, at_low = 0.0, at_high = 0.0, share = 0.5;
  int kept = 0;  // the end that did not move: -1 low, 1 high

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

/// The point at which the surface crosses each edge, within a thousandth of a cell.
std::vector<glm::dvec3> points_on(const std::vector<LatticeEdge>& edges, const Corners& corners,
                                  const Field& field, const Lattice& lattice) {
  std::vector<Root> roots(edges.size());
  std::vector<std::size_t> open(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Place from = place_of(edges[i].from());
    roots[i].at_low = corners.at(from);
    roots[i].at_high = corners.at(from + corner_place(edges[i].along()));
    roots[i].guess();
    open[i] = i;
  }
  const auto place = [&](std::size_t i) {
    return lattice.at(place_of(edges[i].from())) +
           roots[i].share * lattice.cell_mm * glm::dvec3(corner_place(edges[i].along()));
  };
  // Twenty rounds suffice even by bisection alone.
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
  const std::vector<LatticeEdge> edges = edges_of(triangles);
  options.progress.at(0.6);
  Triangles surface;
  surface.points_mm = points_on(edges, corners, field, lattice);
  surface.faces = numbered(triangles, edges);
  options.progress.at(1.0);
  return trusted_solid(std::move(surface), Proof::Construction);
}

MissedWalls missed_walls(const Solid& solid, const Solid& moved, const OffsetOptions& options) {
  const bool inward = options.by_mm < 0.0;
  if (moved.empty()) return {inward ? 0.0 : 1.0, solid.triangles().points_mm.front()};
  constexpr double samples_wanted = 20000.0;
  const double spacing_mm = std::max(options.cell_mm, std::sqrt(solid.measures().area_mm2 / samples_wanted));
  const SurfaceSamples samples = sample_surface(
      solid.triangles(), widened_spacing_mm(solid.triangles(), spacing_mm, 64.0 * samples_wanted));
  const std::vector<std::uint8_t> inside = moved.tree().inside(samples.points_mm);
  std::vector<glm::dvec3> wrong_mm;
  std::vector<double> areas_mm2;
  for (std::size_t i = 0; i < inside.size(); ++i)
    if ((inside[i] != 0) == inward) {
      wrong_mm.push_back(samples.points_mm[i]);
      areas_mm2.push_back(samples.areas_mm2[i]);
    }
  const std::vector<double> distances_mm = moved.tree().distances_mm(wrong_mm);
  MissedWalls missed;
  double missed_mm2 = 0.0;
  for (std::size_t i = wrong_mm.size(); i-- > 0;)
    if (distances_mm[i] > options.cell_mm) {
      missed_mm2 += areas_mm2[i];
      missed.at_mm = wrong_mm[i];
    }
  missed.area_share = missed_mm2 / solid.measures().area_mm2;
  return missed;
}

}  // namespace octotomy::brep
