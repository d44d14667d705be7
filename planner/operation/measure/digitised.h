// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "planner/operation/measure/half_width.h"
#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// The resolution of the plan's universe and scans.
Digitised digitised_of(const AnswerBench& bench);

/// The resolution and uncertainties of an object by its scans, windows and flat parts. A part has at least
/// the uncertainty of the windows of its whole.
Digitised digitised_of(const AnswerBench& bench, const Object& object);

/// The mesh kernel's size of an object, with which the voxel count is compared; none without a mesh.
std::optional<SeenSize> seen_size_of(const Object& object);
/// The reason why an object has no voxels: "'plate' is empty", or that they are too coarse for its mesh.
std::string why_no_voxels(const Object& object);
/// The finding on an object's counted volume if it is_too_coarse; else none.
std::optional<std::string> too_coarse_finding(const Object& object, const HalfWidth& width);

}  // namespace octotomy::planner
