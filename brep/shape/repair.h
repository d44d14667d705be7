// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Which repairs to make; nothing is done that is not asked for. They are made in this order.
struct RepairOptions {
  /// Points no further apart than this become one, chains of them too; 0 joins equal points only. Widths of
  /// what is to stay must be well above it.
  std::optional<double> weld_mm = std::nullopt;
  bool remove_duplicates = false;  ///< of triangles with the same three points all but the first
  bool orient = false;             ///< neighbours alike; closed shells outward, or inward as cavities
  /// Triangles that repeat a point are taken out, others without area as flat_triangles.h says.
  bool remove_flat = false;
  /// Closes holes, each by the triangles of least area and sharpness over its border.
  bool fill_holes = false;
  std::optional<double> longest_hole_mm = std::nullopt;  ///< holes with a longer border stay open
  /// Takes out triangles that intersect and those about them and closes what is left by new ones: moves the
  /// surface there.
  bool remove_intersections = false;
};

/// One thing that was done, or what could not be done.
struct Change {
  std::string step;  ///< weld, duplicates, orient, flat, holes, intersections
  std::string what;  ///< triangles and points by their numbers in what came in
  glm::dvec3 at_mm{0.0};
};

struct Repair {
  Triangles surface;
  std::vector<Change> changes;  ///< every one, in order
  std::vector<Change> left;     ///< what was asked for and could not be done
};

/// Repairs a surface as asked and lists each change. Never moves a point but to weld it to the first of its
/// set or where intersections are taken out. Ask health() what is left to be wished for. Throws
/// std::invalid_argument if an option is out of its range, Error (Input) if a triangle refers to
/// no point or to one that is not finite. Cost: n log n, and most for triangles that intersect.
/// Source: holes after Liepa, "Filling holes in meshes", SGP 2003; both holes and intersections as CGAL has
/// them.
Repair repair(const Triangles& surface, const RepairOptions& options);

}  // namespace octotomy::brep
