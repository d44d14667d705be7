// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "brep/io/mesh_audit.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Joins what a file tore only to repeat points, and leaves out triangles that repeat a corner.
/// - A seam is a pair of open sides that run along the same two places in opposite ways, where no third open
///   side lies. Its points become one where they have the same coordinates, bit for bit; 0.0 and -0.0 are
///   equal. Closed shells have no open sides: where they touch they stay apart.
/// - A triangle that has a point twice is left out. One whose corners coincide and that hangs on no other is
///   one, too.
/// - Where joining would make an edge of more than two triangles, or of two that run along it the same way,
///   nothing is joined: the file's own connection stays.
/// Points that nothing refers to any more are taken out, the others keep their order. Returns the audit's
/// lines, none where nothing was done. Preconditions: all triangles refer to points. Cost: linear where no
/// points coincide and no triangle repeats one, else n log n.
std::vector<MeshFinding> weld_seams(Triangles& triangles);

/// Leaves out triangles that have a point twice, for formats whose reader welds all equal points.
std::vector<MeshFinding> drop_repeating(Triangles& triangles);

}  // namespace octotomy::brep
