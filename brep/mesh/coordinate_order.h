// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The same surface with points and triangles in the order of their coordinates. Corefinement returns them in
/// an order that depends on addresses. Without reordering, the same operands produced different bits in about
/// one run of ten: in the last digits of sums over faces, and in every later decimation or filling of the
/// surface. Points that coincide (by rounding) are ordered by the positions of their neighbours. Throws as
/// check_joins() does if links are invalid, which corefinement of nearly coincident surfaces may cause.
/// Precondition: nothing is marked as deleted. Cost: n log n.
Triangles in_coordinate_order(const Mesh& mesh);
Triangles in_coordinate_order(Triangles triangles);

}  // namespace octotomy::brep
