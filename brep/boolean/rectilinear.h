// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/boolean/corefine.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The wanted results of two surfaces whose triangles are all square to an axis, for example surfaces of
/// voxels and boxes. The surfaces may touch themselves and each other. Their planes divide space into cells,
/// each of which is inside or outside of each surface. Coordinates that are nearer to each other than
/// `tolerance_mm` count as one. Results that touch themselves have a vertex for each sheet. A result has two
/// triangles for each face of a cell on its surface, so it may have many more triangles than the operands.
/// None if a triangle is not square to any axis, if there are more than 4 million cells, or if an operand
/// overlaps itself. Cost: linear in the cells, plus the cells that each triangle covers.
std::optional<Results> rectilinear_results(const Triangles& a, const Triangles& b, const Wanted& wanted,
                                           double tolerance_mm);

}  // namespace octotomy::brep
