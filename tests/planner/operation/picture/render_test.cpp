// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"
#include "voxel/scan/image_file.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(RenderStep, AMovedObjectIsDrawnInItsColourAndColouredByDistance) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"(
      {"id": "moved", "do": "move", "object": "ball", "translate_mm": [2, 0, 0]},
      {"id": "both", "do": "render", "objects": ["ball", "moved"], "path": "both.png", "size": "200x200",
       "width_mm": 64, "colours": ["#ffffff", "#cc7a29"], "annotate": true},
      {"id": "far", "do": "render", "objects": ["moved"], "path": "far.png", "view": "left",
       "colour_by": "distance:ball", "range_mm": 3}, {"id": "xray", "do": "render", "objects": ["ball"],
       "path": "xray.png", "shading": "radiograph"})");
  const Evaluation evaluation = evaluate(plan);
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  ASSERT_EQ(files.size(), 3u);
  for (const Exported& file : files) EXPECT_TRUE(std::filesystem::exists(folder / file.path)) << file.path;
  // The right part of a disc of 20 mm that is moved by 2 mm: its own pixels are of the moved ball.
  const nlohmann::ordered_json& both = files[0].details;
  const double pixel_mm2 = std::pow(both["pixel_mm"].get<double>(), 2);
  EXPECT_NEAR(both["lit_pixels"].get<double>() * pixel_mm2 / (M_PI * 400.0 + 80.0), 1.0, 0.02);
  EXPECT_EQ(both["objects"][1]["colour"], "#cc7a29");
  EXPECT_NEAR(files[1].details["colour_by"]["seen_mm"][1].get<double>(), 2.0, 0.6);
  EXPECT_EQ(files[2].details["shading"], "radiograph");
}

TEST(RenderStep, WhatCannotBeDrawnIsRefused) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& rest) {
    return ball_refusal(folder,
                        R"({"id": "r", "do": "render", "path": "a.png", "objects": ["ball"])" + rest + "}");
  };
  EXPECT_NE(refusal(R"(, "view": "upwards")").find("upwards"), std::string::npos);
  EXPECT_NE(refusal(R"(, "size": "9")").find("WxH"), std::string::npos);
  EXPECT_NE(refusal(R"(, "colour_by": "distance:bal")").find("bal"), std::string::npos);
  EXPECT_NE(refusal(R"(, "colours": ["red"])").find("#RRGGBB"), std::string::npos);
  EXPECT_NE(refusal(R"(, "shading": "mip", "count": true)").find("--count"), std::string::npos);
  EXPECT_NE(refusal(R"(, "opacities": [2])").find("hidden"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
