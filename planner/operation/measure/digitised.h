// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "planner/operation/measure/half_width.h"
#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// How finely the plan's universe and its scans tell places apart.
Digitised digitised_of(const AnswerBench& bench);

/// What the object's scans, windows and flat parts make doubtful. A part is no surer than the windows that
/// its whole was made of.
Digitised digitised_of(const AnswerBench& bench, const Object& object);

/// What the mesh kernel sees of an object, against which its voxels' count is held; none without a mesh.
std::optional<SeenSize> seen_size_of(const Object& object);
/// Why an object without voxels has none: "'plate' is empty", or that they are too coarse for its mesh.
std::string why_no_voxels(const Object& object);
/// What is told of an object's counted volume where it is_too_coarse; none where it is not.
std::optional<std::string> too_coarse_finding(const Object& object, const HalfWidth& width);

}  // namespace octotomy::planner
