// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/stiffness.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

double softest_mpa(const std::filesystem::path& deck) {
  std::ifstream file(deck);
  double softest = 1e9;
  for (std::string line; std::getline(file, line);)
    if (line == "*ELASTIC" && std::getline(file, line)) softest = std::min(softest, std::stod(line));
  return softest;
}

TEST(Stiffness, ADeckOfAMovedObjectTakesTheSamplesOfItsOldPlace) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"(
      {"id": "moved", "do": "move", "object": "ball", "translate_mm": [6, 0, 0]},
      {"id": "here", "do": "deck", "object": "ball", "path": "here.inp",
       "stiffness": {"scan": "ct", "bins": 5, "surface_depth_mm": 2}},
      {"id": "there", "do": "deck", "object": "moved", "path": "there.inp",
       "stiffness": {"scan": "ct", "bins": 5, "surface_depth_mm": 2}})");
  const Evaluation evaluation = evaluate(plan);
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  ASSERT_EQ(files.size(), 2u);
  for (const Exported& file : files) {
    ASSERT_TRUE(file.written) << testing::PrintToString(file.findings);
    // The ball is of 1000 HU throughout, 0.8 g/cm3 by the default calibration: below the surface there is one
    // stiffness, wherever it has moved.
    EXPECT_GT(softest_mpa(folder / file.path), 0.95 * 6850.0 * std::pow(0.8, 1.49)) << file.id;
    EXPECT_NE(testing::PrintToString(file.findings).find("NOT CALIBRATED"), std::string::npos);
  }
}

TEST(Stiffness, RegionsHaveTheirOwnMaterials) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "d", "do": "deck", "object": "ball", "path": "a.inp",
      "fixed": ["ball"], "stiffness": {"scan": "ct"}})")
                .find("stiffness"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
