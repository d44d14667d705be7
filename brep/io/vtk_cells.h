// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/io/mesh_statements.h"

namespace octotomy::brep {

/// Lists of points' numbers, one a cell.
using CellCorners = std::vector<std::vector<long long>>;

/// Adds the surface of an unstructured grid, whose cells have VTK's types: its triangles, quads, pixels,
/// polygons and strips, linear and quadratic; where it has volume cells instead the faces that only one of
/// those has, outward whichever way the cell is wound, and cells of surfaces are left out, which is told.
/// Points and lines are passed over. The points are those of `made`. Throws Error (Input) for other types,
/// and for cells with too few corners. Cost: n log n.
void add_grid_surface(const CellCorners& cells, const std::vector<long long>& types, MeshContent& made);

}  // namespace octotomy::brep
