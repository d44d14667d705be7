// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "brep/io/mesh_audit.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Joins surfaces that a file separated only by repeating points, and leaves out triangles that repeat a
/// corner.
/// - A seam is a pair of open sides between the same two positions in opposite directions, without a third
///   open side there. Its points are merged if their coordinates are equal bit for bit; 0.0 and -0.0 are
///   equal. Closed shells have no open sides, so they stay separate where they touch.
/// - Leaves out a triangle that names a point twice, and a triangle with coinciding corners that shares no
///   side with another.
/// - If joining would create an edge of more than two triangles, or of two with the same direction, nothing
///   is joined. Points that are no longer used are removed; the others keep their order. Returns the audit's
///   lines; empty if nothing changed. Preconditions: all triangles refer to points. Cost: linear if no points
///   coincide and no triangle repeats one, else n log n.
std::vector<MeshFinding> weld_seams(Triangles& triangles);

/// Leaves out triangles that have a point twice, for formats whose reader welds all equal points.
std::vector<MeshFinding> drop_repeating(Triangles& triangles);

}  // namespace octotomy::brep
