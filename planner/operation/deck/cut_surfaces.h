// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "convert/deck/deck.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// The surface of an object's elements by what made it: CUT_<mask> where the plan cut along a mask, OUTER
/// elsewhere; none that is empty. A face of an element is of the kind of the triangle of the object's exact
/// mesh that its middle is nearest to, so that elements need not keep that mesh's triangles. Where several
/// masks made a wall, it is the first's. Precondition: the object has a mesh with triangles. Cost: n log n of
/// triangles and faces.
std::vector<convert::DeckSurface> cut_surfaces(const Object& object, const convert::Tetrahedra& tetrahedra);

}  // namespace octotomy::planner
