// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

Exported montage_of(const ScratchFolder& folder, const std::string& rest) {
  const Plan plan =
      ball_plan(folder, R"({"id": "s", "do": "montage", "scan": "ct", "path": "s.png")" + rest + "}");
  const Evaluation evaluation = evaluate(plan);
  Timings timings;
  std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  return files.at(0);
}

TEST(MontageStep, TheMiddleSlicesOfTheScanStandSideBySide) {
  const ScratchFolder folder;
  const Exported made = montage_of(folder, R"(, "count": 7, "columns": 4)");
  ASSERT_TRUE(made.written) << testing::PrintToString(made.findings);
  EXPECT_EQ(made.details["rows"], 2);
  // 64 samples a side and 2 pixels between.
  EXPECT_EQ(made.details["tile_px"], (nlohmann::ordered_json{64, 64}));
  EXPECT_EQ(made.details["size_px"], (nlohmann::ordered_json{4 * 66 - 2, 2 * 66 - 2}));
  const auto& positions = made.details["positions_mm"];
  ASSERT_EQ(positions.size(), 7u);
  for (std::size_t i = 1; i < 7; ++i)
    EXPECT_DOUBLE_EQ(positions[i].get<double>() - positions[i - 1].get<double>(), 1.0);
  EXPECT_NEAR(positions[3].get<double>(), 0.0, 1.0);
  EXPECT_TRUE(std::filesystem::exists(folder / "s.png"));
}

TEST(MontageStep, AFirstPositionAndADistanceAreTakenAsTheyAre) {
  const ScratchFolder folder;
  const Exported made =
      montage_of(folder, R"(, "plane": "sagittal", "count": 3, "first_mm": -10.5, "apart_mm": 10)");
  ASSERT_TRUE(made.written) << testing::PrintToString(made.findings);
  EXPECT_EQ(made.details["positions_mm"], (nlohmann::ordered_json{-10.5, -0.5, 9.5}));
  EXPECT_EQ(made.details["columns"], 2);
}

TEST(MontageStep, SlicesOutsideOfTheScanAndWrongTonesAreRefused) {
  const ScratchFolder folder;
  const Exported made = montage_of(folder, R"(, "count": 3, "first_mm": 20, "apart_mm": 10)");
  EXPECT_FALSE(made.written);
  ASSERT_EQ(made.findings.size(), 1u);
  EXPECT_NE(made.findings[0].find("slice 3 of 3 at 40"), std::string::npos) << made.findings[0];
  const auto refusal = [&](const std::string& rest) {
    return ball_refusal(folder, R"({"id": "s", "do": "montage", "scan": "ct", "path": "s.png")" + rest + "}");
  };
  EXPECT_NE(refusal(R"(, "count": 0)").find("count"), std::string::npos);
  EXPECT_NE(refusal(R"(, "columns": 0)").find("columns"), std::string::npos);
  EXPECT_NE(refusal(R"(, "apart_mm": 0)").find("apart_mm"), std::string::npos);
  EXPECT_NE(refusal(R"(, "pixel_mm": -1)").find("pixel_mm"), std::string::npos);
  EXPECT_NE(refusal(R"(, "level": [3, 0])").find("above zero"), std::string::npos);
  EXPECT_NE(refusal(R"(, "plane": "oblique")").find("plane"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
