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

/// The slices of the file that a step writes on the ball.
voxel::SliceMask written(const ScratchFolder& folder, const std::string& rest) {
  const Plan plan =
      ball_plan(folder, R"({"id": "c", "do": "contours", "scan": "ct", "path": "c.json", )" + rest + "}");
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluate(plan), folder.path(), timings);
  EXPECT_TRUE(files.at(0).written) << testing::PrintToString(files.at(0).findings);
  return files.at(0).written ? read_slices(folder / "c.json") : voxel::SliceMask{};
}

double widest_mm(const voxel::SliceMask& mask, double position_mm) {
  double widest = 0.0;
  for (const auto& slice : mask.slices)
    if (std::abs(slice.position_mm - position_mm) < 0.01)
      for (const auto& polygon : slice.polygons_mm)
        for (const glm::dvec2& point : polygon) widest = std::max(widest, glm::length(point));
  return widest;
}

TEST(ContoursStep, ASliceHasAThresholdOfItsOwn) {
  const ScratchFolder folder;
  // Samples fall by 2000 within about a millimetre through the ball's surface.
  const voxel::SliceMask mask =
      written(folder, R"("window": "0:", "slice_windows": ["0.5=-800:", "1.5=800:"])");
  EXPECT_NEAR(widest_mm(mask, -0.5), 20.0, 0.1);
  EXPECT_NEAR(widest_mm(mask, 0.5), 20.6, 0.3);
  EXPECT_NEAR(widest_mm(mask, 1.5), 19.6, 0.3);
  const voxel::SliceMask alone = written(folder, R"("slice_windows": ["0.5=-800:", "1.5=800:"])");
  std::size_t slices = 0;
  for (const auto& slice : alone.slices) slices += slice.polygons_mm.empty() ? 0 : 1;
  EXPECT_EQ(slices, 2u);
  EXPECT_EQ(widest_mm(alone, 0.5), widest_mm(mask, 0.5));
}

TEST(ContoursStep, TheRegionAroundAPixelIsThatOfItsSliceAlone) {
  const ScratchFolder folder;
  const voxel::SliceMask by_window =
      written(folder, R"("window": "0:", "around_mm": [[3, 2, 4.5], [0, 0, 4.5]])");
  ASSERT_EQ(by_window.slices.size(), 3u) << "the slice, and an empty one at either end";
  ASSERT_EQ(by_window.slices[1].polygons_mm.size(), 1u) << "both seeds lie in one region";
  EXPECT_NEAR(widest_mm(by_window, 4.5), std::sqrt(400.0 - 4.5 * 4.5), 0.1);
  const voxel::SliceMask by_tolerance = written(folder, R"("tolerance": 1000, "around_mm": [[3, 2, 4.5]])");
  EXPECT_NEAR(widest_mm(by_tolerance, 4.5), std::sqrt(400.0 - 4.5 * 4.5), 0.1);
}

TEST(ContoursStep, WindowsAndPixelsThatCannotBeAreRefusedInALine) {
  const ScratchFolder folder;
  const auto expect = [&](const std::string& rest, const std::string& part) {
    const std::string said = ball_refusal(
        folder, R"({"id": "c", "do": "contours", "scan": "ct", "path": "a.json", )" + rest + "}");
    EXPECT_NE(said.find(part), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  };
  expect(R"("slice_windows": ["250:"])", "POSITION=LOW:HIGH");
  expect(R"("slice_windows": ["30=bonny"])", "'bonny'");
  expect(R"("slice_windows": ["30=250"])", "'250' is no window: give LOW:HIGH or LOW:");
  expect(R"("around_mm": [[0, 0, 0]])", "'tolerance'");
  expect(R"("around_mm": [[0, 0, 0]], "window": "0:", "tolerance": 5)", "leave 'window' out");
  expect(R"("window": "0:", "tolerance": 5)", "add 'around_mm'");
  expect(R"("around_mm": [[0, 0, 0]], "seeds_mm": [[0, 0, 0]])", "leave 'seeds_mm'");
  expect(R"("around_mm": [[0, 0, 0]], "window": "0:", "slice_windows": ["0=1:"])", "leave 'around_mm' out");
  const auto unwritten = [&](const std::string& rest, const std::string& part) {
    const Plan plan =
        ball_plan(folder, R"({"id": "c", "do": "contours", "scan": "ct", "path": "a.json", )" + rest + "}");
    Timings timings;
    const std::vector<Exported> files = write_files(plan, evaluate(plan), folder.path(), timings);
    EXPECT_FALSE(files.at(0).written);
    EXPECT_NE(testing::PrintToString(files.at(0).findings).find(part), std::string::npos)
        << testing::PrintToString(files.at(0).findings);
  };
  unwritten(R"("slice_windows": ["400=0:"])", "there is no slice at 400 mm");
  unwritten(R"("slice_windows": ["0.5=0:", "0.6=9:"])", "two separate windows");
  unwritten(R"("around_mm": [[28, 0, 0]], "window": "0:")", "its sample is -1000");
  unwritten(R"("around_mm": [[280, 0, 0]], "window": "0:")", "lies outside of the scan");
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
