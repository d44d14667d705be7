// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace octotomy::planner {

/// The version of plans that this program writes and evaluates.
inline constexpr int plan_version = 1;

/// Functions that raise a plan by one version: the first entry makes version 2 from version 1.
using Migrations = std::vector<std::function<void(nlohmann::json& plan)>>;

/// Raises a plan to version 1 + the number of migrations, one version at a time. Throws std::runtime_error if
/// its version is missing, is not an integer from 1, or is newer than that.
void migrate(nlohmann::json& plan, const Migrations& migrations);

/// The migrations of this program: plan_version - 1 of them.
const Migrations& migrations();

}  // namespace octotomy::planner
