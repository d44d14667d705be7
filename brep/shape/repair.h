// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/progress.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The repairs to make, in this order. Nothing else is changed.
struct RepairOptions {
  /// Points within this distance are merged, also in chains; 0 merges only equal points. Must be well below
  /// the width of parts to preserve.
  std::optional<double> weld_mm = std::nullopt;
  bool remove_duplicates = false;  ///< removes triangles with the same three points as an earlier one
  bool orient = false;             ///< orients neighbours consistently; closed shells outward, or inward as
                                   ///< cavities
  /// Removes triangles that repeat a point, and others without area as in flat_triangles.h.
  bool remove_flat = false;
  /// Closes each hole by the triangles of least area and sharpness over its border.
  bool fill_holes = false;
  std::optional<double> longest_hole_mm = std::nullopt;  ///< holes with a longer border stay open
  /// Removes triangles that intersect and those around them, and closes the gaps by new ones, which moves the
  /// surface there.
  bool remove_intersections = false;
  /// The result is closed and free of self-intersection. Runs all steps above, also those not requested. If
  /// the result is not a solid, closed shells are united by united_shells(); if that fails, the surface is
  /// reconstructed by enclose(). Closed shells within others are bodies or cavities by their orientation, if
  /// all outermost shells of the input face outward. The options of enclose():
  bool solid = false;
  std::optional<double> cell_mm = std::nullopt;
  bool hull = false;
  /// Largest share of the volume that removing intersections and enclosing may gain or lose, above 0.
  double max_volume_share = 0.05;
  Progress progress = {};
  /// With `solid`: turns the surface as given, with its holes, into a wall of this thickness, as thickened()
  /// does; the volume may then change. For sheets, which enclose nothing.
  std::optional<double> wall_mm = std::nullopt;
};

/// One change that was made, or that could not be made.
struct Change {
  std::string step;  ///< weld, duplicates, orient, flat, fans, holes, intersections, solid
  std::string what;  ///< text that names triangles and points by their numbers in the input
  glm::dvec3 at_mm{0.0};
};

struct Repair {
  Triangles surface;
  std::vector<Change> changes;             ///< every change, in order
  std::vector<Change> left;                ///< requested changes that could not be made
  std::optional<double> enclosed_cell_mm;  ///< the lattice's cell, if the surface was reconstructed
};

/// Repairs a surface by the options and lists each change. Moves points only to weld each to the first of its
/// set, to remove intersections or to enclose the surface. Edges of three and more triangles, and points
/// where several fans meet, are split as split_fans() does wherever a step or the result needs it. Orients
/// triangles last, until health() finds them consistent. Removes triangles with points that are not finite if
/// `solid` is set. health() reports the faults that remain. Throws std::invalid_argument if an option is out
/// of its range, Error (Input) if a triangle refers to no point or to one that is not finite, Error
/// (Geometry) as enclose(), or if the volume changes by more than `max_volume_share`. That message contains
/// both volumes and, after enclosing, options that would be accepted; Stopped. Cost: n log n; removing
/// intersections costs most. With `solid`, which can enclose instead, they are removed only from surfaces of
/// up to 100 000 triangles. Source: holes after Liepa, "Filling holes in meshes", SGP 2003; holes and
/// intersections as implemented in CGAL.
Repair repair(const Triangles& surface, const RepairOptions& options);

/// A surface whose triangles wind alike.
struct TurnedAlike {
  Triangles surface;
  std::size_t turned = 0;  ///< triangles that were turned
};
/// Turns triangles until neighbours wind alike, shells face outward and cavities inward; nothing else changes.
/// Throws as repair().
TurnedAlike turned_alike(const Triangles& surface);

}  // namespace octotomy::brep
