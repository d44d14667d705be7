// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "brep/io/mesh_audit.h"
#include "brep/mesh/triangles.h"

// Triangulates polygons of mesh files.
namespace octotomy::brep {

/// Counts of polygons by kind. A member `first_...` is the number of the first polygon of that kind among all
/// faces of the file, from 0.
struct PolygonCounts {
  std::size_t faces = 0;         ///< all faces, triangles included
  std::size_t polygons = 0;      ///< faces with more than three corners
  std::size_t bent = 0;          ///< polygons that are not planar to the file's precision
  std::size_t crossing = 0;      ///< polygons that cross themselves, so that no triangles fill them
  std::size_t repeating = 0;     ///< polygons with a corner twice in a row
  std::size_t without_area = 0;  ///< polygons with all corners on a line, or with fewer than three different
                                 ///< ones
  std::size_t first_bent = 0, first_crossing = 0, first_without_area = 0;
  double most_bent = 0.0;  ///< largest distance of a corner from its polygon's plane, file's unit

  /// The audit's lines about the polygons; `unit_mm` is the file's unit.
  std::vector<MeshFinding> findings(double unit_mm) const;
};

/// Appends polygons to triangles. No points are added and each side of a polygon is a side of one of its
/// triangles, so that neighbours stay joined; corners in the middle of a straight side stay, too.
class PolygonSplitter {
 public:
  /// `triangles` and `counts` must outlive this object.
  PolygonSplitter(Triangles& triangles, PolygonCounts& counts) : triangles_(triangles), counts_(counts) {}

  /// Appends a polygon as triangles that wind as it does:
  /// 1 Three corners become one triangle, even if it has no area.
  /// 2 If there are more, successive equal corners are merged. If fewer than three are left, the polygon is
  ///   counted and left out.
  /// 3 If all triangles of the fan from the first corner face the same way and the fan turns by less than a
  ///   full circle, the fan is used.
  /// 4 Otherwise the polygon is cut into ears, the most nearly equilateral first (Meisters, Polygons have
  ///   ears, 1975). Exact predicates decide in the projection along the polygon's main axis. The polygon may
  ///   be concave, or have a hole that a double side joins to the outline.
  /// 5 A polygon that crosses itself, or with three or more corners but no area, becomes the fan and is
  ///   counted.
  /// Throws Error (Input) if there are fewer than three corners or a corner is no number of a point. Cost:
  /// usually n log n, n^2 at worst.
  void add(std::span<const long long> corners);
  /// Appends a strip of triangles. Triangles that repeat a point only change the strip's direction and are
  /// left out.
  void add_strip(std::span<const long long> corners);

 private:
  void add_fan(const std::vector<std::uint32_t>& corners);
  void note_bent(const std::vector<std::uint32_t>& corners, const glm::dvec3& normal);

  Triangles& triangles_;
  PolygonCounts& counts_;
};

}  // namespace octotomy::brep
