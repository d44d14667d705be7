// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/mesh/solid.h"

namespace octotomy::brep {

struct Imprinted {
  Solid a, b;
  double moved_mm = 0.0;  ///< largest distance of a new point from the triangle or side that it divides
};

/// Divides two solids so that both have the same triangles wherever triangles of both lie on one plane,
/// except for the rounding of points; for example a bone and a piece cut from it, in any pose. Points of one
/// solid that lie on triangles or sides of the other divide these. Where points of both differ only by
/// rounding, both solids get the first solid's point. None if no triangles meet on one plane, if more than
/// 200 000 triangles reach into the other's box, or if rounding leaves sides that cross. Cost: as
/// for_each_coplanar_pair(), and n log n.
std::optional<Imprinted> imprinted(const Solid& a, const Solid& b);

}  // namespace octotomy::brep
