// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "planner/plan/answers.h"
#include "tests/planner/operation/ball_operation.h"
#include "voxel/scan/image_file.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(SliceStep, ThePictureIsInTrueScaleAndTellsTheOutlinesArea) {
  const ScratchFolder folder;
  const Plan plan =
      ball_plan(folder, R"({"id": "axial", "do": "slice", "scan": "ct", "path": "pictures/axial.png",
      "axial": "12", "objects": ["ball"], "level": [0, 2000]})");
  const Evaluation evaluation = evaluate(plan);
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  ASSERT_EQ(files.size(), 1u);
  EXPECT_TRUE(std::filesystem::exists(folder / "pictures" / "axial.png"));
  const nlohmann::ordered_json& said = files[0].details;
  EXPECT_EQ(said["plane"], "axial");
  EXPECT_EQ(said["size_px"], (nlohmann::ordered_json{64, 64}));
  EXPECT_NEAR(said["outlines"][0]["area_mm2"].get<double>() / (M_PI * (400.0 - 144.0)), 1.0, 0.05);
}

TEST(SliceStep, WhatCannotBeDrawnIsRefused) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& rest) {
    return ball_refusal(folder, R"({"id": "s", "do": "slice", "scan": "ct")" + rest + "}");
  };
  EXPECT_NE(refusal(R"(, "path": "a.stl")").find(".png"), std::string::npos);
  EXPECT_NE(refusal(R"(, "path": "a.png", "window": "bone", "level": [1, 2])").find("leave one of them out"),
            std::string::npos);
  EXPECT_NE(refusal(R"(, "path": "a.png", "level": [1, 0])").find("above zero"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
