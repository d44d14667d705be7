// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// Which crowns a scan replaces, and how. LPS millimetres.
struct ScanBlendOptions {
  glm::dvec3 to_roots{0, 0, 1};  ///< unit, from the tips of the teeth to their roots
  double tips_mm = 0.0;          ///< p . to_roots of the tips
  double depth_mm = 5.0;         ///< crowns are replaced from the tips to this depth, above 0
  /// Along this width the surface changes from the scan's to the solid's: at the depth, at the scan's borders
  /// and holes, and at `radius_mm`. Above 0.
  double blend_mm = 1.5;
  /// The solid's surface within this distance of the scan is replaced, above 0. Streaks of the solid that
  /// stick out farther stay.
  double reach_mm = 1.5;
  std::vector<glm::dvec3> about_mm =
      {};                  ///< replaces only within `radius_mm` of these points; empty: all that the scan
                           ///< shows
  double radius_mm = 6.0;  ///< above 0
  /// Edge of the cells of the new triangles, above 0. Sharp edges are cut off within a cell. Time and memory
  /// grow with its inverse square.
  double cell_mm = 0.25;
  Progress progress = {};
};

/// The area of the surface by its source, mm².
struct SurfaceSources {
  double scan_mm2 = 0.0, border_mm2 = 0.0, solid_mm2 = 0.0;
};

struct ScanBlend {
  Solid solid;
  SurfaceSources sources;
  double largest_move_mm = 0.0;  ///< largest distance of the part from the scan to the surface before
  double shift_mm = 0.0;         ///< as in BooleanResult
  std::vector<std::string> findings;
};

/// The largest distance of the new triangles from the surface that they approximate, where one source alone
/// counts. It occurs in gaps between teeth and at sharp edges, which cells cut off. Along the border the
/// slope of the weight increases it.
double scan_blend_allowance_mm(const ScanBlendOptions& options);

/// The solid with a part of its surface replaced by an open scan that lies on it. The distances to both are
/// mixed with a weight that changes smoothly along `blend_mm`, so that the border is smooth. Near the crowns
/// the surface is made anew from distances; elsewhere the triangles stay. Where the surface passes through
/// the box about the crowns, there is a step of up to a quarter of a cell. The number of cells is bounded; an
/// arch takes 0.4 GB in cells of 0.25 mm and 0.9 GB in cells of 0.1 mm. Throws std::invalid_argument if an
/// option is out of its range; Error (Geometry) if the scan shows none of the crowns; std::length_error if
/// the cells are too many; as boolean(); Stopped. The same bits on any number of threads. Cost: two distances
/// for each cell near the surface in the box of the crowns, and two Booleans.
ScanBlend blended_with_scan(const Solid& solid, const Mesh& scan, const ScanBlendOptions& options);

}  // namespace octotomy::brep
