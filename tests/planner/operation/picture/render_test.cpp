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

TEST(RenderStep, AnExpressionIsDrawnWithoutBeingMadeAsTheObjectThatACombineStepMakesOfIt) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"(
      {"id": "moved", "do": "move", "object": "ball", "translate_mm": [9, 0, 0]},
      {"id": "left", "do": "combine", "expression": "ball - moved"},
      {"id": "made", "do": "render", "objects": ["left"], "path": "made.png", "size": "120x120",
       "width_mm": 64, "centre_mm": [0, 0, 0], "shading": "gradient", "view": "35,15"},
      {"id": "unmade", "do": "render", "expression": "ball - moved", "path": "unmade.png", "size": "120x120",
       "width_mm": 64, "centre_mm": [0, 0, 0], "shading": "gradient", "view": "35,15"})");
  const Evaluation evaluation = evaluate(plan);
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[1].details["expression"], "ball - moved");
  EXPECT_GT(files[0].details["lit_pixels"].get<int>(), 1000);
  EXPECT_EQ(files[0].details["lit_pixels"], files[1].details["lit_pixels"]);
  EXPECT_EQ(files[0].details["depth_range_mm"], files[1].details["depth_range_mm"]);
}

TEST(RenderStep, DecisionsLightsDensitiesAndReliefsAreStepsToo) {
  const ScratchFolder folder;
  const std::string frame = R"("size": "64x64", "width_mm": 64, "picks": ["32,32"])";
  const Plan plan = ball_plan(folder, R"(
      {"id": "a", "do": "render", "objects": ["ball"], "path": "a.png", "decide": "range", )" +
                                          frame + R"(},
      {"id": "b", "do": "render", "objects": ["ball"], "path": "b.png", "decide": "gradient",
       "steeper_per_mm": 1, )" + frame + R"(},
      {"id": "c", "do": "render", "objects": ["ball"], "path": "c.png", "lights": ["0,0,1"], "ambient": 0,
       "diffuse": 0, "specular": 0, )" + frame +
                                          R"(},
      {"id": "d", "do": "render", "objects": ["ball"], "path": "d.png",
       "density_colours": ["-32000:32000:#ff0000"], )" +
                                          frame + R"(},
      {"id": "e", "do": "render", "objects": ["ball"], "path": "e.png", "relief": 16, )" +
                                          frame + R"(})");
  const Evaluation evaluation = evaluate(plan);
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  ASSERT_EQ(files.size(), 5u);
  const auto pick = [&](std::size_t i) { return files[i].details["picks"][0]; };
  // The ball's front, 20 mm before the origin.
  EXPECT_NEAR(pick(0)["point_mm"][1].get<double>(), -20.0, 0.1);
  EXPECT_EQ(files[1].details["decide"], "gradient");
  EXPECT_GT(files[1].details["lit_pixels"].get<int>(), 500);
  EXPECT_EQ(pick(2)["colour"], "#000000");
  const auto red = pick(3)["colour"].get<std::string>();
  EXPECT_NE(red.substr(1, 2), "00");
  EXPECT_LT(red.substr(3), "4000") << red;
  EXPECT_EQ(files[4].details["relief"]["corners"], 81);
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

TEST(RenderStep, EachChoiceThatCannotBeReadOrChangesNothingIsRefusedInOneLine) {
  const ScratchFolder folder;
  for (const auto& [rest, word] : std::vector<std::pair<std::string, std::string>>{
           {R"("lights": ["1,1"])", "RIGHT,UP,FRONT"},
           {R"("lights": ["0,0,0"])", "direction"},
           {R"("lights": ["0,0,1,2"])", "strength"},
           {R"("lights": ["0,0,1,0.5"], "diffuse": 0.5)", "strength of its own"},
           {R"("ambient": 2)", "ambient"},
           {R"("diffuse": -1)", "diffuse"},
           {R"("specular": 0, "specular_exponent": 9)", "mirrored"},
           {R"("specular_exponent": 0)", "specular_exponent"},
           {R"("shading": "depth", "lights": ["0,0,1"])", "lit surfaces"},
           {R"("shading": "mip", "ambient": 0.1)", "lit surfaces"},
           {R"("shading": "composite", "specular": 0.1)", "mirror"},
           {R"("decide": "slope")", "gradient"},
           {R"("decide": "gradient")", "--steeper"},
           {R"("steeper_per_mm": 3)", "'decide'"},
           {R"("decide": "gradient", "steeper_per_mm": 0)", "steeper_per_mm"},
           {R"("peel": 0)", "peel"},
           {R"("peel": 1, "shading": "mip")", "surfaces"},
           {R"("decide": "range", "algorithm": "ray_cast")", "--algorithm"},
           {R"("decide": "range", "count": true)", "--count"},
           {R"("decide": "range", "shading": "context")", "--shading context"},
           {R"("dissolve": ["0:1"])", "radiograph"},
           {R"("shading": "radiograph", "dissolve": ["1:0"])", "LOW:HIGH"},
           {R"("shading": "radiograph", "dissolve": ["0:1:-2"])", "share"},
           {R"("gradient_opacity": "1:2")", "composite"},
           {R"("shading": "composite", "gradient_opacity": "2:1")", "CLEAR:OPAQUE"},
           {R"("density_colours": ["0:1:red"])", "#RRGGBB"},
           {R"("density_colours": ["0:1:#ff0000"], "shading": "outline")", "coloured surfaces"},
           {R"("density_colours": ["0:1:#ff0000"], "colour_by": "distance:ball")", "colour_by"},
           {R"("shading": "density", "colours": ["#ff0000"])", "density"},
           {R"("relief": 2)", "relief"},
           {R"("relief": 20, "colours": ["#ff0000"])", "black lines"},
           {R"("relief": 20, "shading": "mip")", "depths"},
           {R"("expression": "ball &")", "expression"},
           {R"("expression": "ball & bell")", "bell"},
           {R"("expression": "ball", "shading": "mip")", "--expression"},
           {R"("expression": "ball", "cut_planes": ["1,0,0,0"], "cut_face": "grey")", "samples"},
       }) {
    const std::string said = ball_refusal(
        folder, R"({"id": "r", "do": "render", "path": "a.png", "objects": ["ball"], )" + rest + "}");
    EXPECT_NE(said.find(word), std::string::npos) << rest << "\n" << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << rest;
  }
  EXPECT_NE(ball_refusal(folder, R"({"id": "r", "do": "render", "path": "a.png"})").find("expression"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
