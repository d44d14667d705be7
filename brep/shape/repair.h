// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/progress.h"
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
  /// Closed and free of self-intersection in any case: where the steps above, those of them too that were not
  /// asked for, leave no solid, closed shells are united by united_shells(); where that has no answer, the
  /// surface is made anew by enclose(). Closed shells within others stay bodies or cavities as they are
  /// turned, where all outermost ones came in turned outward. The cell and hull of enclose():
  bool solid = false;
  std::optional<double> cell_mm = std::nullopt;
  bool hull = false;
  /// Of the volume that taking out intersections and enclosing may gain or lose, above 0.
  double max_volume_share = 0.05;
  Progress progress = {};
};

/// One thing that was done, or what could not be done.
struct Change {
  std::string step;  ///< weld, duplicates, orient, flat, fans, holes, intersections, solid
  std::string what;  ///< triangles and points by their numbers in what came in
  glm::dvec3 at_mm{0.0};
};

struct Repair {
  Triangles surface;
  std::vector<Change> changes;             ///< every one, in order
  std::vector<Change> left;                ///< what was asked for and could not be done
  std::optional<double> enclosed_cell_mm;  ///< where the surface was made anew, the lattice's cell
};

/// Repairs a surface as asked and lists each change. Never moves a point but to weld it to the first of its
/// set, where intersections are taken out or the surface is enclosed. Edges of three and more triangles, and
/// points where several fans meet, are split as split_fans() does wherever a step or the result needs it.
/// Orients last, until health() agrees. Triangles with points that are not finite are taken out where `solid`
/// is asked for. Ask health() what is left to be wished for. Throws std::invalid_argument if an option is out
/// of its range, Error (Input) if a triangle refers to no point or to one that is not finite, Error
/// (Geometry) with both volumes if the volume changes by more than its share, of an enclosing with what would
/// be accepted in its place, or as enclose(); Stopped. Cost:
/// n log n, and most for triangles that intersect: those are taken out of up to 100 000 triangles only, when
/// `solid` can enclose instead. Source: holes after Liepa, "Filling holes in meshes", SGP 2003; both holes
/// and intersections as CGAL has them.
Repair repair(const Triangles& surface, const RepairOptions& options);

/// How far one surface is from another that was made of it.
struct RepairEffect {
  /// Of solids the exact sum over their triangles; of other surfaces, also open ones, by line_volumes().
  double volume_before_mm3 = 0.0, volume_after_mm3 = 0.0;
  double open_line_share = 0.0;  ///< of the lines that the volume before leaves out
  double area_before_mm2 = 0.0, area_after_mm2 = 0.0;
  /// Of corners and middles of triangles of either surface from the other.
  double largest_distance_mm = 0.0;
  glm::dvec3 largest_at_mm{0.0};
};

/// Which of both surfaces health() has found to be solids.
struct KnownSolids {
  bool before = false, after = false;
};

/// Precondition: both have triangles. Triangles with points that are not finite are left out. Cost: n log n,
/// parallel.
RepairEffect repair_effect(const Triangles& before, const Triangles& after, const KnownSolids& solids = {});

}  // namespace octotomy::brep
