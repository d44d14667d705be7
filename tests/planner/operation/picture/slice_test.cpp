// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/slice.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

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

TEST(SliceStep, AHatchedObjectIsDrawnByDiagonalLinesWithinItsOutline) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "axial", "do": "slice", "scan": "ct", "path": "axial.png",
      "axial": "12", "hatched": ["ball"], "level": [0, 2000]})");
  EvaluateOptions options;
  options.keep_scans = true;
  const Evaluation evaluation = evaluate(plan, options);
  Slice slice;
  slice.axial = "12";
  slice.plain = true;
  slice.level = {0.0, 2000.0};
  const auto ball = std::find_if(evaluation.objects.begin(), evaluation.objects.end(),
                                 [](const Object& object) { return object.id == "ball"; });
  ASSERT_NE(ball, evaluation.objects.end());
  Timings timings;
  const SlicePicture picture =
      slice_of(slice, evaluation.loaded.at("ct")->scene(), {{"ball", ball->voxel.octree, true}}, timings, {});
  const std::size_t width = static_cast<std::size_t>(picture.size_px.x);
  double on_lines = 0.0, elsewhere = 0.0;
  for (std::size_t pixel = 0; pixel < picture.rgb.size() / 3; ++pixel)
    if (picture.rgb[3 * pixel] == 0xe5 && picture.rgb[3 * pixel + 1] == 0x48)
      ((pixel % width + pixel / width) % 8 < 2 ? on_lines : elsewhere) += 1.0;
  const auto& said = picture.said["outlines"][0];
  EXPECT_NEAR(on_lines / said["pixels"].get<double>(), 0.25, 0.05);
  EXPECT_GT(elsewhere, 0.0);
  EXPECT_LE(elsewhere, said["outline_pixels"].get<double>());
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].details["outlines"][0]["pixels"], said["pixels"]);
}

TEST(SliceStep, WhatCannotBeDrawnIsRefused) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& rest) {
    return ball_refusal(folder, R"({"id": "s", "do": "slice", "scan": "ct")" + rest + "}");
  };
  EXPECT_NE(refusal(R"(, "path": "a.stl")").find(".png"), std::string::npos);
  EXPECT_NE(refusal(R"(, "path": "a.png", "window": "bone", "level": [1, 2])").find("leave out one of them"),
            std::string::npos);
  EXPECT_NE(refusal(R"(, "path": "a.png", "level": [1, 0])").find("above zero"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
