// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/field.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// Refuses a part that is listed among the objects on which it sits.
void check_against(const ObjectName& part, const std::vector<ObjectName>& against,
                   const FieldLocation& place);

/// A finding that states which kernel has no solid of an object; none if both have one. `consequence`, such
/// as "nothing can be seated", ends the finding if the object has no voxels.
std::optional<std::string> missing_kernel(const Object& object, const std::string& consequence);

}  // namespace octotomy::planner
