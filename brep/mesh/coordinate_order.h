// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The same surface with points and triangles in the order of their coordinates. Corefinement leaves them in
/// an order that hangs on addresses, so that the same operands gave other bits in about one run of ten: sums
/// over faces in their last places, and all that decimates or fills the surface later on. Points at one place
/// (rounded together) go by the places of their neighbours. Throws as check_joins() if links are torn,
/// which corefinement of surfaces that all but coincide may leave. Precondition: nothing is marked as
/// deleted. Cost: n log n.
Triangles in_coordinate_order(const Mesh& mesh);

}  // namespace octotomy::brep
