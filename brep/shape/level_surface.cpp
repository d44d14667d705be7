// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 bisect tetrahedra until the distance is linear in each that the surface may pass; 2 find the surface on
// each edge of these whose ends lie on different sides; 3 join those points.
#include "brep/shape/level_surface.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/shape/bisected_lattice.h"
#include "brep/shape/kuhn_cells.h"

namespace octotomy::brep {
namespace {

/// A lattice around the offset solid, with a power of two of cells along each side.
struct Lattice {
  glm::dvec3 origin_mm{0.0};
  double step_mm = 1.0;
  int side = 2;

  glm::dvec3 at(const glm::dvec3& place) const { return origin_mm + step_mm * place; }
  glm::dvec3 at(std::uint64_t key) const { return at(glm::dvec3(place_of(key))); }
};

/// Sharp edges of the offset surface are cut off within a step. So steps are finer than the cells of rounded
/// parts, which are not divided further once they are flat enough.
constexpr double steps_a_cell = 4.0;

Lattice lattice_about(const Size& size, const OffsetOptions& options) {
  // Shifted by irregular shares of a cell, so that planes at round coordinates do not coincide with lattice
  // planes, where a surface would consist of slivers.
  const double margin = std::max(options.by_mm, 0.0) + 2.0 * options.cell_mm;
  const glm::dvec3 odd_mm = options.cell_mm * glm::dvec3(0.2718281828, 0.3141592653, 0.1414213562);
  const glm::dvec3 extent = size.high_mm - size.low_mm + 2.0 * margin;
  const double steps = steps_a_cell * std::max({extent.x, extent.y, extent.z}) / options.cell_mm;
  if (!(steps < (1 << (side_bits - 1))))
    throw TooLarge("cells of " + std::to_string(options.cell_mm) + " mm are too small for a solid of " +
                   std::to_string(std::max({extent.x, extent.y, extent.z})) +
                   " mm: a side has at most 2^17 of them");
  Lattice lattice{size.low_mm - margin + odd_mm, options.cell_mm / steps_a_cell, 2};
  while (lattice.side < steps) lattice.side *= 2;
  return lattice;
}

/// The root between two places of opposite sign, by regula falsi. If one end stays in place twice in a row,
/// its value is halved, so that this end moves as well (Illinois method).
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

/// Edges in the order in which triangles use them. Neighbours in this order are near in space, so that each
/// search starts near its end.
std::vector<std::uint32_t> by_first_use(const std::vector<std::array<std::uint32_t, 3>>& faces,
                                        std::size_t edge_count) {
  std::vector<std::uint8_t> is_used(edge_count, 0);
  std::vector<std::uint32_t> order;
  order.reserve(edge_count);
  for (const auto& face : faces)
    for (const std::uint32_t edge : face)
      if (is_used[edge] == 0) {
        is_used[edge] = 1;
        order.push_back(edge);
      }
  return order;
}

/// The points where the surface crosses edges, within a thousandth of a cell. `open` contains the number of
/// each edge once; the searches follow its order.
std::vector<glm::dvec3> points_on(const std::vector<CutEdge>& edges, std::vector<std::uint32_t> open,
                                  const BisectedLattice& bisected, const LevelField& field,
                                  const Lattice& lattice) {
  assert(open.size() == edges.size());
  std::vector<Root> roots(edges.size());
  tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t i) {
    roots[i].at_low = bisected.distances_mm.at(edges[i].from);
    roots[i].at_high = bisected.distances_mm.at(edges[i].to);
    roots[i].guess();
  });
  std::vector<std::uint32_t> nearest(edges.size(), SurfaceTree::unknown_triangle);
  const auto place = [&](std::size_t i) {
    const glm::dvec3 from = lattice.at(edges[i].from);
    return from + roots[i].share * (lattice.at(edges[i].to) - from);
  };
  // Twenty-four rounds suffice even if each only halves the interval.
  for (int round = 0; round < 24 && !open.empty(); ++round) {
    std::vector<glm::dvec3> tried_mm(open.size());
    tbb::parallel_for(std::size_t{0}, open.size(), [&](std::size_t k) { tried_mm[k] = place(open[k]); });
    const std::vector<double> values = field(tried_mm, nearest);
    assert(values.size() == open.size());
    std::size_t still_open = 0;
    for (std::size_t k = 0; k < open.size(); ++k) {
      if (std::abs(values[k]) <= 0x1p-9 * lattice.step_mm) continue;
      Root& root = roots[open[k]];
      root.learn(values[k]);
      root.guess();
      nearest[still_open] = nearest[k];
      open[still_open++] = open[k];
    }
    open.resize(still_open);
    nearest.resize(still_open);
  }
  std::vector<glm::dvec3> points_mm;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    roots[i].share = std::clamp(roots[i].share, nearest_end, 1.0 - nearest_end);
    points_mm.push_back(place(i));
  }
  return points_mm;
}

}  // namespace

Solid level_surface(const LevelField& field, const Size& size, const OffsetOptions& options) {
  const Lattice lattice = lattice_about(size, options);
  // A ball of radius |by_mm| rolls along one side of the surface: the bumps of an outward offset and the
  // dents of an inward one are at least that wide.
  const BisectionOptions bisection{.side = lattice.side,
                                   .step_mm = lattice.step_mm,
                                   .tolerance_mm = offset_tolerance_mm(options),
                                   .narrowest_mm = std::max(std::abs(options.by_mm), 2.0 * options.cell_mm)};
  const BisectedLattice bisected = bisected_lattice(
      bisection,
      [&](const std::vector<glm::dvec3>& places) {
        std::vector<glm::dvec3> points_mm(places.size());
        tbb::parallel_for(std::size_t{0}, places.size(),
                          [&](std::size_t i) { points_mm[i] = lattice.at(places[i]); });
        std::vector<std::uint32_t> nearest(points_mm.size(), SurfaceTree::unknown_triangle);
        return field(points_mm, nearest);
      },
      [&] { options.progress.at(0.1); });
  options.progress.at(0.6);
  const std::vector<std::array<CutEdge, 3>> triangles = triangles_of(bisected);
  const std::vector<CutEdge> edges = edges_of(triangles);
  Triangles surface;
  surface.faces = numbered(triangles, edges);
  surface.points_mm = points_on(edges, by_first_use(surface.faces, edges.size()), bisected, field, lattice);
  options.progress.at(1.0);
  return trusted_solid(std::move(surface), Proof::Construction);
}

}  // namespace octotomy::brep
