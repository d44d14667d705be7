// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/migration.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace octotomy::planner {
namespace {

using Json = nlohmann::json;

TEST(Migration, AnOldPlanIsRaisedAVersionAtATime) {
  const Migrations two{
      [](Json& plan) { plan["a"] = plan["name"]; },
      [](Json& plan) { plan["b"] = plan["a"].get<std::string>() + plan["a"].get<std::string>(); }};
  Json plan{{"octotomy_plan", 1}, {"name", "x"}};
  migrate(plan, two);
  EXPECT_EQ(plan, (Json{{"octotomy_plan", 3}, {"name", "x"}, {"a", "x"}, {"b", "xx"}}));
  Json newer{{"octotomy_plan", 2}, {"a", "y"}};
  migrate(newer, two);
  EXPECT_EQ(newer.at("b"), "yy");
}

TEST(Migration, AVersionOfTheFutureIsRefusedAndThereIsAWayToEachPresentOne) {
  EXPECT_EQ(static_cast<int>(migrations().size()), plan_version - 1);
  for (const Json& version : {Json(plan_version + 1), Json(0), Json("1"), Json(1.5)}) {
    Json plan{{"octotomy_plan", version}};
    EXPECT_THROW(migrate(plan, migrations()), std::runtime_error) << version;
  }
}

}  // namespace
}  // namespace octotomy::planner
