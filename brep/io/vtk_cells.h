// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/io/mesh_statements.h"

namespace octotomy::brep {

/// Lists of point numbers, one per cell.
using CellCorners = std::vector<std::vector<long long>>;

/// Adds the surface of an unstructured grid with cells of VTK's types: its triangles, quads, pixels, polygons
/// and strips, linear and quadratic. If it has volume cells, adds instead the faces that belong to only one
/// of these, oriented outward for either winding of the cell; surface cells are then left out and reported.
/// Ignores points and lines. Uses the points of `made`. Throws Error (Input) for other types, and for cells
/// with too few corners. Cost: n log n.
void add_grid_surface(const CellCorners& cells, const std::vector<long long>& types, MeshContent& made);

}  // namespace octotomy::brep
