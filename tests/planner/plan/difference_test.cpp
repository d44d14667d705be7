// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/difference.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace octotomy::planner {
namespace {

Plan plan_of(const std::string& steps, const std::string& name = "p") {
  return parse_plan(R"({"octotomy_plan": 1, "name": ")" + name +
                        R"(", "scans": {"ct": {"path": "a.nrrd", "sha256": null}},
      "steps": [)" + steps +
                        "]}",
                    ".");
}

constexpr const char* skull = R"({"id": "skull", "do": "window", "scan": "ct", "low": 300})";
const std::string skull_moved = R"({"id": "m", "do": "move", "object": "skull", "translate_mm": [0, -6, 2],
    "rotate": {"degrees": 5, "axis": [1, 0, 0]}})";

TEST(Difference, ADefaultThatIsSaidAndTheOrderOfKeysAreNone) {
  const PlanDifference none = difference(
      plan_of(std::string(skull) + "," + skull_moved),
      plan_of(R"({"low": 300.0, "do": "window", "id": "skull", "scan": "ct"}, {"id": "m", "do": "move",
          "object": "skull", "translate_mm": [0, -6, 2],
          "rotate": {"degrees": 5, "axis": [1, 0, 0], "about_mm": [0, 0, 0]}})"));
  EXPECT_TRUE(none.is_empty()) << text_of(none);
  EXPECT_EQ(text_of(none), "the plans are the same\n");
}

TEST(Difference, StepsAndFieldsAreNamedByTheirPlace) {
  const PlanDifference found = difference(
      plan_of(std::string(skull) + "," + skull_moved + R"(, {"id": "size", "do": "measure", "object": "m"})"),
      plan_of(std::string(skull) +
                  R"(, {"id": "twin", "do": "mirror", "object": "skull"}, {"id": "m", "do": "move",
          "object": "skull", "translate_mm": [0, -7, 2], "rotate": {"degrees": 4, "axis": [1, 0, 0]}})",
              "q"));
  EXPECT_EQ(text_of(found),
            "~ name: \"p\" -> \"q\"\n"
            "- step 'size'\n"
            "~ step 'm', translate_mm: [0.0,-6.0,2.0] -> [0.0,-7.0,2.0]\n"
            "~ step 'm', rotate, degrees: 5.0 -> 4.0\n"
            "+ step 'twin'\n");
  const auto json = to_json(found);
  EXPECT_EQ(json.at("changed")[0].at("fields")[1].at("field"), "rotate, degrees");
  EXPECT_EQ(json.at("same"), false);
}

TEST(Difference, APointWithinAListIsNamedByItsNumber) {
  const auto points = [](const char* up) {
    return plan_of(std::string(skull) + R"(, {"id": "m", "do": "move", "object": "skull", "points": [
        {"at": [0, 0, 0], "up_mm": 1}, {"at": [9, 0, 0], "up_mm": )" +
                   up + "}]}");
  };
  const PlanDifference found = difference(points("2"), points("3"));
  EXPECT_EQ(text_of(found), "~ step 'm', points[1], up_mm: 2.0 -> 3.0\n");
}

TEST(Difference, AnotherOrderIsToldOnce) {
  const std::string a = R"({"id": "a", "do": "mirror", "object": "skull"})",
                    b = R"({"id": "b", "do": "mirror", "object": "skull"})";
  const PlanDifference found = difference(plan_of(std::string(skull) + "," + a + "," + b),
                                          plan_of(std::string(skull) + "," + b + "," + a));
  EXPECT_FALSE(found.is_empty());
  EXPECT_EQ(found.reordered, (std::vector<std::string>{"b", "a"}));
}

/// The steps of both plans that follow another step than before, computed by comparing all pairs.
std::vector<std::string> plainly_reordered(const std::string& from, const std::string& to) {
  const auto before = [](const std::string& plan, const std::string& other, char id) {
    char last = ' ';
    for (const char each : plan.substr(0, plan.find(id)))
      if (other.find(each) != std::string::npos) last = each;
    return last;
  };
  std::vector<std::string> ids;
  for (const char id : to)
    if (from.find(id) != std::string::npos && before(from, to, id) != before(to, from, id))
      ids.emplace_back(1, id);
  return ids;
}

/// Some of the steps a to j in any order.
std::string random_order(std::mt19937& random) {
  std::string ids = "abcdefghij";
  std::shuffle(ids.begin(), ids.end(), random);
  ids.resize(1 + random() % ids.size());
  return ids;
}

TEST(Difference, AddedRemovedAndReorderedAreThoseOfALookAtAllPairs) {
  std::size_t reordered = 0, kept = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 random(seed);
    const std::string from = random_order(random), to = random_order(random);
    const auto plan = [](const std::string& ids) {
      std::string steps = skull;
      for (const char id : ids)
        steps += R"(,{"id": ")" + std::string(1, id) + R"(", "do": "mirror", "object": "skull"})";
      return plan_of(steps);
    };
    const auto lacking = [](const std::string& ids, const std::string& in) {
      std::vector<std::string> found;
      for (const char id : ids)
        if (in.find(id) == std::string::npos) found.emplace_back(1, id);
      return found;
    };
    const PlanDifference found = difference(plan(from), plan(to));
    EXPECT_EQ(found.removed, lacking(from, to)) << "seed " << seed;
    EXPECT_EQ(found.added, lacking(to, from)) << "seed " << seed;
    EXPECT_EQ(found.reordered, plainly_reordered('0' + from, '0' + to)) << "seed " << seed;
    reordered += found.reordered.size();
    kept += found.reordered.empty();
  }
  EXPECT_GT(reordered, 100U);
  EXPECT_GT(kept, 10U);
}

}  // namespace
}  // namespace octotomy::planner
