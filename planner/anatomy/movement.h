// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "planner/table/object.h"
#include "planner/table/scope.h"

namespace octotomy::planner {

/// What each moved object's last step moved, in the order of the objects: the motion, its turns, the
/// displacement of the object's centroid and of the landmarks that lie on it, in words and along the head's
/// directions; where earlier steps moved the object, too, the displacements since the scan. A landmark lies
/// on an object that has a voxel within 3 mm of it: surgeons place landmarks on skin-side bone to about that.
/// Cost: a small Boolean a landmark and object.
nlohmann::ordered_json movements_json(const Objects& objects, const std::vector<NamedPoint>& landmarks);

}  // namespace octotomy::planner
