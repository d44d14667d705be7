// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/plan/caveats.h"

namespace octotomy::planner {

/// States the origin of an object. Adds to each kernel's answer the code that made it and the makers of its
/// operands, and to the object the inputs that both kernels share. `found_values`: the step has computed
/// values once for both kernels. Precondition: both kernels have answered.
void add_makers(const MadeOf& from, bool found_values, Object& made);

}  // namespace octotomy::planner
