// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace octotomy::planner {

/// The version of plans that this program writes and evaluates.
inline constexpr int plan_version = 1;

/// Turns a plan of one version into the next: the first entry makes version 2 of version 1.
using Migrations = std::vector<std::function<void(nlohmann::json& plan)>>;

/// Raises a plan to version 1 + the number of migrations, a version at a time. Throws std::runtime_error
/// where its version is missing, is no whole number from 1, or is newer than that.
void migrate(nlohmann::json& plan, const Migrations& migrations);

/// The migrations of this program: as many as plan_version is above 1.
const Migrations& migrations();

}  // namespace octotomy::planner
