// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "convert/deck/deck.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// The surface of an object's elements by origin: CUT_<mask> where the plan cut along a mask, OUTER
/// elsewhere; empty surfaces are left out. The origin of an element's face is that of the nearest triangle of
/// the object's exact mesh to the face's centre, so that elements need not contain that mesh's triangles. A
/// wall made by several masks belongs to the first. Precondition: the object has a mesh with triangles. Cost:
/// n log n of triangles and faces.
std::vector<convert::DeckSurface> cut_surfaces(const Object& object, const convert::Tetrahedra& tetrahedra);

}  // namespace octotomy::planner
