// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace octotomy::planner {

/// The version of the plan format that this program writes and evaluates.
inline constexpr int plan_version = 1;

/// Functions that each change a plan to the next version. The first one makes version 2 from version 1.
using Migrations = std::vector<std::function<void(nlohmann::json& plan)>>;

/// Changes a plan to version 1 + the number of migrations, step by step. Throws std::runtime_error if its
/// version is not an integer from 1 on, or is newer. A plan without a version stays as it is, for its reader
/// to report.
void migrate(nlohmann::json& plan, const Migrations& migrations);

/// The plan_version - 1 migrations of this program.
const Migrations& migrations();

}  // namespace octotomy::planner
