// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <vector>

#include "brep/contour/tile_sections.h"

namespace octotomy::brep {

/// How an object continues between its drawn sections.
enum class Between {
  shape_based,  ///< where the distances to both outlines, negative inside, weighted by nearness, sum to at
                ///< most zero (Raya and Udupa 1990)
  nearest       ///< as in the nearer section
};

struct SectionsBetweenOptions {
  Between between = Between::shape_based;
  /// The largest distance between sections that tile_sections() joins, and twice the spacing of samples in an
  /// added section; above 0. Straight tiles deviate from a rounded surface by about step_mm squared over
  /// eight radii.
  double step_mm = 1.0;
  std::stop_token stop = {};
};

/// Half the height of the step between two sections that are not joined; an eighth of their distance if that
/// is less.
constexpr double half_terrace_mm() {
  return 1e-3;
}

/// Adds sections between drawn ones, so that tile_sections() makes the object that the drawn sections
/// describe. Between two sections that are not empty, sections follow at most step_mm apart; their points lie
/// on the interpolated outline to about 1e-3 of the step. A section without contours ends the object half way
/// to it, in a flat face. The first and the last section end it at half the distance to their neighbours.
/// Sides longer than step_mm are divided. The first and last section of the result are empty. Throws
/// std::invalid_argument unless there are two or more sections in ascending order; if a contour is open, has
/// fewer than three points or one that is not finite; or if an option is out of its range. Precondition:
/// contours do not cross. Throws Stopped. Cost: about a microsecond for each sample beside an outline;
/// parallel, the same bits on any number of threads. Source: Raya and Udupa, "Shape-based interpolation of
/// multidimensional objects", IEEE Trans. Medical Imaging 9, 1990. Departure: distances are exact, and
/// outlines are followed on samples and then moved onto the exact outline along the samples' edges.
std::vector<Section> sections_between(const std::vector<Section>& drawn,
                                      const SectionsBetweenOptions& options = {});

/// The surface tiled from sections_between().
struct TiledBetween {
  Triangles surface;           ///< as tile_sections() makes it
  std::size_t sections = 0;    ///< number of sections that were tiled
  bool is_whole_flat = false;  ///< flat ends, steps and upright walls lie exactly in their planes
  bool is_apart = false;       ///< no two of its triangles intersect, by an exact search
};

/// Tiles drawn sections with others between them. If the result is a solid, points that tile_sections() and
/// half_terrace_mm() moved are moved back to their sections, so that flat parts lie exactly in their planes.
/// Throws as sections_between() and tile_sections(). Cost: that of both, and of one or two searches by
/// health().
TiledBetween tile_between(const std::vector<Section>& drawn, const SectionsBetweenOptions& options = {},
                          std::optional<TileCost> cost = TileCost::shortest_span);

}  // namespace octotomy::brep
