// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/merge.h"

#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/difference.h"

namespace octotomy::planner {
namespace {

Json base() {
  return Json::parse(R"({"octotomy_plan": 1, "name": "p", "scans": {"ct": {"path": "a.nrrd", "sha256": null}},
    "steps": [
      {"id": "skull", "do": "window", "scan": "ct", "low": 300},
      {"id": "m", "do": "move", "object": "skull", "translate_mm": [0, -6, 2], "rotate": {"degrees": 5,
          "axis": [1, 0, 0]}},
      {"id": "size", "do": "measure", "object": "m"}]})");
}
Plan plan(const Json& json) {
  return parse_plan(json.dump(), ".");
}
Merged merged(const Json& a, const Json& b) {
  return merge(plan(base()), plan(a), plan(b));
}

TEST(Merge, ChangesOfDifferentFieldsStepsAndNamesMeet) {
  Json a = base(), b = base();
  a["name"] = "mine";
  a["steps"][1]["rotate"]["degrees"] = 7;
  a["steps"].insert(a["steps"].begin() + 1, Json{{"id", "twin"}, {"do", "mirror"}, {"object", "skull"}});
  b["steps"][1]["translate_mm"] = {0, -9, 2};
  b["steps"].push_back(Json{{"id", "gap"}, {"do", "measure"}, {"object", "m"}, {"to", "skull"}});
  b["steps"].erase(2);  // size
  b["universe"] = {{"voxel_mm", 1.0}};
  const Merged one = merged(a, b);
  ASSERT_TRUE(one.conflicts.empty()) << one.conflicts[0].text();
  const Plan result = parse_plan(one.text, ".");
  std::string order;
  for (const Step& step : result.steps) order += step.id + " ";
  EXPECT_EQ(order, "skull twin m gap ");
  EXPECT_EQ(text_of(difference(plan(base()), result)),
            "~ name: \"p\" -> \"mine\"\n~ universe: null -> {\"voxel_mm\":1.0}\n- step 'size'\n"
            "~ step 'm', translate_mm: [0.0,-6.0,2.0] -> [0.0,-9.0,2.0]\n"
            "~ step 'm', rotate, degrees: 5.0 -> 7.0\n+ step 'twin'\n+ step 'gap'\n");
  // The other way round it is the same plan.
  EXPECT_TRUE(difference(result, parse_plan(merged(b, a).text, ".")).reordered.size() <= 2);
  EXPECT_TRUE(difference(result, parse_plan(merged(b, a).text, ".")).changed.empty());
}

TEST(Merge, BothThatChangeOneFieldAreNamedByStepAndField) {
  Json a = base(), b = base();
  a["steps"][1]["translate_mm"] = {0, -7, 2};
  b["steps"][1]["translate_mm"] = {0, -5, 2};
  const Merged one = merged(a, b);
  EXPECT_EQ(one.text, "");
  ASSERT_EQ(one.conflicts.size(), 1u);
  EXPECT_EQ(one.conflicts[0].text(),
            "step 'm', translate_mm: [0,-6,2] became [0,-7,2] in A and [0,-5,2] in B");
  b["steps"][1]["translate_mm"] = {0, -7, 2};
  EXPECT_TRUE(merged(a, b).conflicts.empty()) << "the same change is none";
}

TEST(Merge, AStepThatOneRemovesAndTheOtherChangesIsAConflict) {
  Json a = base(), b = base();
  a["steps"].erase(2);
  b["steps"][2]["object"] = "skull";
  const Merged one = merged(a, b);
  ASSERT_EQ(one.conflicts.size(), 1u);
  EXPECT_EQ(one.conflicts[0].text(), "step 'size': removed in A, changed in B");
}

TEST(Merge, OneNewIdForTwoThingsIsAConflict) {
  Json a = base(), b = base();
  a["steps"].push_back(Json{{"id", "x"}, {"do", "mirror"}, {"object", "skull"}});
  b["steps"].push_back(Json{{"id", "x"}, {"do", "mirror"}, {"object", "m"}});
  const Merged one = merged(a, b);
  ASSERT_EQ(one.conflicts.size(), 1u);
  EXPECT_EQ(one.conflicts[0].step, "x");
  EXPECT_EQ(one.conflicts[0].field, "object");
}

TEST(Merge, ChangesThatAreAtPeaceAndMakeNoPlanAreRefusedByPlace) {
  Json a = base(), b = base();
  a["steps"].erase(1);
  a["steps"][1]["object"] = "skull";  // size, no longer of m
  b["steps"].push_back(Json{{"id", "twin"}, {"do", "mirror"}, {"object", "m"}});
  try {
    merged(a, b);
    FAIL() << "'twin' mirrors a step that is gone";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("step 'twin', object: no earlier step is called 'm'"),
              std::string::npos)
        << error.what();
  }
}

TEST(Merge, AddedStepsStandBehindTheOnesThatTheyFollow) {
  Json a = base(), b = base();
  const auto add = [](Json& plan, std::size_t place, const char* id) {
    plan["steps"].insert(plan["steps"].begin() + static_cast<std::ptrdiff_t>(place),
                         Json{{"id", id}, {"do", "window"}, {"scan", "ct"}, {"low", 300}});
  };
  add(a, 0, "a_first");
  add(a, 1, "a_second");
  add(a, 5, "a_last");
  add(b, 0, "b_first");
  add(b, 2, "b_third");
  add(b, 5, "b_last");
  const Merged one = merged(a, b);
  ASSERT_TRUE(one.conflicts.empty()) << one.conflicts[0].text();
  std::string order;
  for (const Step& step : parse_plan(one.text, ".").steps) order += step.id + " ";
  EXPECT_EQ(order, "a_first a_second b_first skull b_third m size a_last b_last ");
}

}  // namespace
}  // namespace octotomy::planner
