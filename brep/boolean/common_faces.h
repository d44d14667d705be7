// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// The union of two solids that have whole triangles in common, one's turned about, and else lie apart, as
/// the pieces of one cut do: these triangles go, and the points about them become one. Nothing moves, and no
/// triangle is divided. None where no triangle is in common, or where what is left is no closed surface: a
/// Boolean is asked for then. Precondition: the insides are disjoint. Cost: linear.
std::optional<Solid> united_at_common_faces(const Solid& a, const Solid& b);

}  // namespace octotomy::brep
