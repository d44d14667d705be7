// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <set>
#include <string>

#include "planner/plan.h"
#include "planner/plan_keys.h"

namespace octotomy::planner {

/// Reads a step that exports; its path joins those taken. Throws std::runtime_error saying step, key and what
/// to try.
ExportStep read_export_step(const Keys& keys, const Bound& bound, std::set<std::string>& taken);

}  // namespace octotomy::planner
