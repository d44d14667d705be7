// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "planner/operation/measure/half_width.h"
#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// The resolution of a plan: its voxels and its coarsest scan.
Digitised digitised_of(const AnswerBench& bench);

/// The resolution of an object, with the uncertainties from its windows and flat parts. A part of an object
/// has at least the uncertainty of the whole object's windows.
Digitised digitised_of(const AnswerBench& bench, const Object& object);

/// The size of an object by its mesh, with which the count of its voxels is compared; none without a mesh.
std::optional<SeenSize> seen_size_of(const Object& object);
/// The reason why an object has no voxels: the object is empty, such as "'plate' is empty", or the voxels are
/// too coarse for its mesh.
std::string why_no_voxels(const Object& object);
/// A finding on the counted volume of an object if the half-width is_too_coarse; else none.
std::optional<std::string> too_coarse_finding(const Object& object, const HalfWidth& width);

}  // namespace octotomy::planner
