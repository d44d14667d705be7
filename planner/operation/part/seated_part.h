// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/field.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// Refuses a part that is among the objects on which it sits.
void check_against(const ObjectName& part, const std::vector<ObjectName>& against,
                   const FieldLocation& place);

/// The kernel whose solid an object lacks, as a finding; none if both kernels have one. `consequence` ends the
/// finding of an object without voxels: "nothing can be seated".
std::optional<std::string> missing_kernel(const Object& object, const std::string& consequence);

}  // namespace octotomy::planner
