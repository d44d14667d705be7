// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/migration.h"

#include <nlohmann/json.hpp>

#include "planner/operation/table/json_file.h"

namespace octotomy::planner {

void migrate(nlohmann::json& plan, const Migrations& migrations) {
  const auto found = plan.find("octotomy_plan");
  if (found == plan.end()) return;  // the caller reports that the version is missing
  const int newest = 1 + static_cast<int>(migrations.size());
  if (!found->is_number_integer() || found->get<std::int64_t>() < 1)
    refuse("octotomy_plan", "must be a version of plans, from 1 to " + std::to_string(newest));
  if (found->get<std::int64_t>() > newest)
    refuse("octotomy_plan", "must be 1" + (newest > 1 ? " to " + std::to_string(newest) : std::string()) +
                                ", because this program reads no later version of plans: a newer program "
                                "wrote this plan, install that one");
  for (int version = found->get<int>(); version < newest; ++version) {
    migrations[static_cast<std::size_t>(version - 1)](plan);
    plan["octotomy_plan"] = version + 1;
  }
}

const Migrations& migrations() {
  static const Migrations all(static_cast<std::size_t>(plan_version - 1));
  return all;
}

}  // namespace octotomy::planner
