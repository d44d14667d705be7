// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/measure/half_width.h"
#include "planner/table/bench.h"

namespace octotomy::planner {

/// How finely the plan's universe and its scans tell places apart.
Digitised digitised_of(const AnswerBench& bench);

/// What the object's scans, windows and flat parts make doubtful. A part is no surer than the windows that
/// its whole was made of.
Digitised digitised_of(const AnswerBench& bench, const Object& object);

}  // namespace octotomy::planner
