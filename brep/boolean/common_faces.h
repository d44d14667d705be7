// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// The union of two solids that share whole triangles with opposite winding and are otherwise disjoint, like
/// the pieces of one cut. Removes these triangles and merges their points. No point moves, and no triangle is
/// divided. None if no triangle is shared or if the rest is not a closed surface; the caller then needs a
/// Boolean. Precondition: the interiors are disjoint. Cost: linear.
std::optional<Solid> united_at_common_faces(const Solid& a, const Solid& b);

}  // namespace octotomy::brep
