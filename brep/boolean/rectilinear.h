// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/boolean/corefine.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The wanted results of two surfaces whose triangles are all square to an axis, as sets of voxels and boxes
/// are, whether or not they touch themselves or each other: the planes of both divide space into cells, which
/// are in or out. Coordinates that are nearer to each other than `tolerance_mm` count as one. Results that
/// touch themselves have a vertex for each sheet. A result has two triangles for each cell's face, so that it
/// may have many more than the operands. None if a triangle is square to no axis, if there are more than
/// 4 million cells, or if an operand overlaps itself. Cost: the cells, and for each triangle those that it
/// covers.
std::optional<Results> rectilinear_results(const Triangles& a, const Triangles& b, const Wanted& wanted,
                                           double tolerance_mm);

}  // namespace octotomy::brep
