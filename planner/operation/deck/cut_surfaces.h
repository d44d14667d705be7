// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "convert/deck/deck.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// Divides the surface of an object's elements by origin: CUT_<mask> where the plan cut along a mask, OUTER
/// elsewhere. Empty surfaces are left out. A face has the origin of the triangle of the object's exact mesh
/// that is nearest to the face's centre; the elements need not contain that triangle. A wall made by several
/// masks belongs to the first. Precondition: the object has a mesh with triangles. Cost: n log n of triangles
/// and faces.
std::vector<convert::DeckSurface> cut_surfaces(const Object& object, const convert::Tetrahedra& tetrahedra);

}  // namespace octotomy::planner
