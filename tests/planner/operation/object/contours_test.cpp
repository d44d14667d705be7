// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/file/region_file.h"
#include "planner/operation/table/json.h"
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

TEST(ContoursStep, ASeedOnAnEdgeGivesItsSliceTheThresholdOfItsSample) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "lines", "do": "contours", "scan": "ct", "path": "lines.json",
      "seeds_mm": [[19.5, 3.5, 1.5], [-0.5, -15.5, 12.5]]})");
  const Evaluation evaluation = evaluate(plan);
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  ASSERT_EQ(files.size(), 1u);
  ASSERT_TRUE(files[0].written);
  const voxel::SliceMask mask = read_slices(folder / "lines.json");
  // The slices of both seeds, and an empty one at either end.
  ASSERT_EQ(mask.slices.size(), 4u);
  EXPECT_TRUE(mask.slices.front().polygons_mm.empty());
  EXPECT_TRUE(mask.slices.back().polygons_mm.empty());
  for (const std::size_t k : {1u, 2u}) {
    ASSERT_EQ(mask.slices[k].polygons_mm.size(), 1u);
    // The seeds' samples are less than half a millimetre from the ball's surface.
    const double radius =
        std::sqrt(ball_radius_mm * ball_radius_mm - mask.slices[k].position_mm * mask.slices[k].position_mm);
    for (const glm::dvec2& point : mask.slices[k].polygons_mm[0])
      EXPECT_NEAR(glm::length(point), radius, 0.3);
  }
  const Json& seeds = files[0].details["seeds"];
  ASSERT_EQ(seeds.size(), 2u) << files[0].details.dump();
  const auto sample = [](const glm::dvec3& p) {
    return std::round(2000.0 * (ball_radius_mm - glm::length(p)));
  };
  EXPECT_EQ(seeds[0]["threshold"], sample({19.5, 3.5, 1.5}));
  EXPECT_EQ(seeds[1]["threshold"], sample({-0.5, -15.5, 12.5}));
  for (const Json& seed : seeds) EXPECT_LT(seed["away_mm"].get<double>(), 0.01);
  EXPECT_TRUE(files[0].findings.empty());
}

TEST(ContoursStep, SeedsThatCannotBeAreRefused) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& rest) {
    return ball_refusal(folder,
                        R"({"id": "c", "do": "contours", "scan": "ct", "path": "a.json", )" + rest + "}");
  };
  EXPECT_NE(refusal(R"("window": "0:", "seeds_mm": [[0, 0, 0]])").find("leave 'window' out"),
            std::string::npos);
  EXPECT_NE(refusal(R"("seeds_mm": [[0, 0]])").find("seeds_mm"), std::string::npos);
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
