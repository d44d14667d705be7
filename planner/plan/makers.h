// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/plan/caveats.h"

namespace octotomy::planner {

/// Adds to both kernels' answers the code that made them, from their operands on, and to the object what both
/// took from one place. `found_values`: the step found values once for both kernels. Precondition: both
/// kernels have answered.
void add_makers(const MadeOf& from, bool found_values, Object& made);

}  // namespace octotomy::planner
