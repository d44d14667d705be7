// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/migration.h"

#include <gtest/gtest.h>

#include "planner/operation/table/json.h"

namespace octotomy::planner {
namespace {

TEST(Migration, AnOldPlanIsRaisedAVersionAtATime) {
  const Migrations two{
      [](SortedJson& plan) { plan["a"] = plan["name"]; },
      [](SortedJson& plan) { plan["b"] = plan["a"].get<std::string>() + plan["a"].get<std::string>(); }};
  SortedJson plan{{"octotomy_plan", 1}, {"name", "x"}};
  migrate(plan, two);
  EXPECT_EQ(plan, (SortedJson{{"octotomy_plan", 3}, {"name", "x"}, {"a", "x"}, {"b", "xx"}}));
  SortedJson newer{{"octotomy_plan", 2}, {"a", "y"}};
  migrate(newer, two);
  EXPECT_EQ(newer.at("b"), "yy");
}

TEST(Migration, AVersionOfTheFutureIsRefusedAndThereIsAWayToEachPresentOne) {
  EXPECT_EQ(static_cast<int>(migrations().size()), plan_version - 1);
  for (const SortedJson& version :
       {SortedJson(plan_version + 1), SortedJson(0), SortedJson("1"), SortedJson(1.5)}) {
    SortedJson plan{{"octotomy_plan", version}};
    EXPECT_THROW(migrate(plan, migrations()), std::runtime_error) << version;
  }
}

}  // namespace
}  // namespace octotomy::planner
