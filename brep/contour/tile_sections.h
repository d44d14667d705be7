// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "brep/contour/contour.h"
#include "brep/contour/tile.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The contours of an object in the plane z_mm: closed and disjoint, as follow() and edits produce them. They
/// may be nested; their direction does not matter.
struct Section {
  double z_mm = 0.0;
  std::vector<Contour> contours;
};

struct TileSectionsOptions {
  /// How a contour with one counterpart is joined to it. None: all are joined by overlay(), whose triangles
  /// cannot cross but are thinner.
  std::optional<TileCost> cost = TileCost::shortest_span;
  std::function<void(double)> progress = {};  ///< called with 0..1, from any thread, one call at a time
  std::stop_token stop = {};
  /// The largest distance in the plane between two points, one of each contour, that a strip may join. A pair
  /// whose strips need longer spans is joined by overlay(). Not set: no limit.
  std::optional<double> most_span_mm = std::nullopt;
};

struct TiledSections {
  Triangles surface;
  std::size_t strips = 0;  ///< pairs of contours joined by a strip
  /// Of `strips`: pairs whose best strip crossed itself or another surface, or would enclose a volume twice. They
  /// were joined by the best strip whose spans cross no contour (tile_clear(), tile_clear_aligned()).
  std::size_t clear_strips = 0;
  /// Of `strips`: pairs whose clear strip crossed something, too. They were joined by the best strip near the
  /// strip of shortest spans (tile_near()), by the strip of shortest spans, by the strip of least area, or by the best
  /// strip near the shortest spans that cross no other surface (tile_apart(), tile_about()).
  std::size_t narrowed_strips = 0;
  /// Pairs joined by overlay() because each of their strips crossed something or was too long.
  std::size_t crossed_strips = 0;
  std::size_t overlaid = 0;  ///< further groups of contours: branchings, ends, contours within contours
};

/// The surface of an object that is given by sections: closed, oriented outward, manifold and, up to
/// rounding, without self-intersection. Contours are connected if the areas they bound overlap. Branches are
/// joined by saddles half way between sections. Ends, also of holes, are closed by a roof half way to the
/// next section; beyond the first and last section at half the distance to their neighbour (1 mm for a single
/// section). The distances of sections may vary. To prevent contours of neighbours from coinciding, every
/// other section is moved by 2^-30 of the largest coordinate, a quarter of a nanometre on a head. In section
/// coordinates: x and y of the contours, z up. Throws std::invalid_argument if sections are not in ascending
/// order, or a contour is open, has fewer than three points or one that is not finite; Error (Geometry),
/// which names section and contours, if two of one section cross or touch. Cost: about 40 us per point;
/// parallel over sections, the same bits on any number of threads. Source: sections are overlaid as in
/// Boissonnat's "Shape reconstruction from planar cross sections" (1988), but in the plane instead of with
/// Delaunay tetrahedra; tile.h for strips.
TiledSections tile_sections(const std::vector<Section>& sections, const TileSectionsOptions& options = {});

}  // namespace octotomy::brep
