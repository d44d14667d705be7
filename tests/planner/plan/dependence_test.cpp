// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/dependence.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// Two branches of one ball.
std::string steps(const std::string& up_mm, const std::string& front_mm = "[0, -20, 0]") {
  return R"({"id": "marks", "do": "landmarks", "points": [{"name": "front", "point_mm": )" + front_mm +
         R"(}]},
      {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "cap", "do": "combine", "expression": "ball & cut"},
      {"id": "cup", "do": "combine", "expression": "ball - cut"},
      {"id": "moved", "do": "move", "object": "cap", "translate_mm": [0, 0, )" +
         up_mm + R"(]},
      {"id": "turned", "do": "move", "object": "cup", "turn": {"pitch_deg": 5, "about_mm": "front"}},
      {"id": "size", "do": "measure", "object": "moved"})";
}

std::map<std::string, std::string> keys(const std::string& text) {
  const ScratchFolder folder;
  return step_keys(ball_plan(folder, text), "common",
                   [](const std::string& scan) { return "key of " + scan; });
}

std::set<std::string> changed(const std::map<std::string, std::string>& a,
                              const std::map<std::string, std::string>& b) {
  std::set<std::string> ids;
  for (const auto& [id, key] : a)
    if (b.at(id) != key) ids.insert(id);
  return ids;
}

using Ids = std::set<std::string>;

TEST(Dependence, AStepNeedsWhatItIsMadeOfAndNothingElse) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, steps("2"));
  EXPECT_EQ(needed_for(plan, {"moved"}), (Ids{"ball", "cut", "cap", "moved"}));
  EXPECT_EQ(needed_for(plan, {"cut"}), Ids{"cut"});
  EXPECT_THROW(needed_for(plan, {"none"}), std::invalid_argument);
}

TEST(Dependence, OnlyStepsThatHangOnAChangeGetAnotherKey) {
  const auto base = keys(steps("2"));
  EXPECT_EQ(changed(base, keys(steps("2"))), Ids{});
  EXPECT_EQ(changed(base, keys(steps("3"))), (Ids{"moved", "size"}));
  EXPECT_EQ(changed(base, keys(steps("2", "[0, -21, 0]"))), (Ids{"marks", "turned"}))
      << "a landmark is an input";
  const auto held = keys(R"({"id": "held", "do": "head_position", "pitch_deg": 3}, )" + steps("2"));
  EXPECT_EQ(changed(base, held), (Ids{"cut", "cap", "cup", "moved", "turned", "size"}))
      << "views are the head's";
  EXPECT_EQ(base.at("ball"), held.at("ball"));
}

TEST(Dependence, AFileThatAStepReadsCountsByItsContent) {
  const ScratchFolder folder;
  const auto key = [&](const char* point) {
    std::ofstream(folder / "a.json") << R"({"landmarks": [{"name": "a", "point_mm": )" << point << "}]}";
    const Plan plan = ball_plan(folder, R"({"id": "marks", "do": "landmarks", "file": "a.json"})");
    return step_keys(plan, "", [](const std::string&) { return ""; }).at("marks");
  };
  const std::string first = key("[0, 0, 0]");
  EXPECT_EQ(first, key("[0, 0, 0]"));
  EXPECT_NE(first, key("[0, 0, 1]"));
}

TEST(Dependence, MeshesAreNeededByWhatIsFittedOnThem) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, steps("2") + R"(,
      {"id": "twin", "do": "mirror", "object": "cap", "fit": true}, {"id": "all", "do": "combine",
          "expression": "twin | cup"})");
  EXPECT_EQ(needing_meshes(plan, needed_for(plan, {"moved"})), Ids{});
  EXPECT_EQ(needing_meshes(plan, needed_for(plan, {"all"})), (Ids{"ball", "cut", "cap"}));
}

}  // namespace
}  // namespace octotomy::planner
