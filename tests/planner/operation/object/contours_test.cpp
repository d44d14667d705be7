// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "planner/operation/file/region_file.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(ContoursStep, TheFileHoldsTheSlicesOfTheBallMovedOut) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "lines", "do": "contours", "scan": "ct", "path": "lines.json",
      "window": "0:", "by_mm": 2})");
  const Evaluation evaluation = evaluate(plan);
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  ASSERT_EQ(files.size(), 1u);
  EXPECT_TRUE(files[0].written);
  const voxel::SliceMask mask = read_slices(folder / "lines.json");
  EXPECT_GE(mask.slices.size(), 39u);
  double widest_mm = 0.0;
  for (const auto& slice : mask.slices)
    for (const auto& polygon : slice.polygons_mm)
      for (const glm::dvec2& point : polygon) widest_mm = std::max(widest_mm, glm::length(point));
  EXPECT_NEAR(widest_mm, ball_radius_mm + 2.0, 0.1);
}

TEST(ContoursStep, AFileThatIsNoJsonAndAMissingWindowAreRefused) {
  const ScratchFolder folder;
  EXPECT_NE(
      ball_refusal(folder, R"({"id": "c", "do": "contours", "scan": "ct", "path": "a.stl", "window": "0:"})")
          .find(".json"),
      std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "c", "do": "contours", "scan": "ct", "path": "a.json"})")
                .find("'window' is missing"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
