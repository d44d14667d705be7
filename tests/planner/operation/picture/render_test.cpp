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

/// A cap that moved into the rest of the ball, cut through the middle. Each pixel of the cut face that lies a
/// voxel inside of its piece shows the sample of the piece that is named first, moved with it.
TEST(RenderStep, CutFacesOfMovedObjectsShowTheirOwnSamplesInEitherOrder) {
  const auto sample = [](const glm::dvec3& p_mm) { return 700.0 + 30.0 * p_mm.x - 12.0 * p_mm.z; };
  for (const bool is_moved_first : {true, false}) {
    const ScratchFolder folder;
    const std::string both = is_moved_first ? "moved | rest" : "rest | moved";
    const Plan plan = ball_plan(folder, R"(
        {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
            "polygons_mm": [[[-22, 5], [22, 5], [22, 22], [-22, 22]]]}]},
        {"id": "piece", "do": "combine", "expression": "ball & cut"},
        {"id": "rest", "do": "combine", "expression": "ball - cut"},
        {"id": "moved", "do": "move", "object": "piece", "translate_mm": [4, 0, -3]},
        {"id": "both", "do": "combine", "expression": ")" +
                                            both + R"("},
        {"id": "face", "do": "render", "objects": ["both"], "path": "face.png", "size": "96x96",
         "width_mm": 48, "centre_mm": [0, 0, 0], "cut_planes": ["0,-1,0,-0.5"], "cut_face": "grey",
         "tones": "0:1400", "colours": ["#ffffff"]})");
    voxel::Scene scene = ball_scene(ball_radius_mm);
    auto& samples = std::get<voxel::Int16Samples>(scene.samples);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const glm::dvec3 p_mm = glm::dvec3(i % 64, i / 64 % 64, i / 4096) - 31.5;
      if (samples[i] > 0) samples[i] = static_cast<std::int16_t>(sample(p_mm));
    }
    voxel::write_scene(scene, folder / "ball.nrrd");
    EvaluateOptions quick;
    quick.certify = quick.meshes = false;
    const Evaluation evaluation = evaluate(plan, quick);
    Timings timings;
    ASSERT_TRUE(write_files(plan, evaluation, folder.path(), timings).at(0).written);
    const voxel::StoredImage face = voxel::read_images(folder / "face.png").at(0);
    int of_moved = 0, of_rest = 0;
    for (int row = 0; row < 96; ++row)
      for (int column = 0; column < 96; ++column) {
        const glm::dvec3 p_mm(0.5 * (column - 47.5), 0.5, 0.5 * (47.5 - row)),
            from_mm = p_mm - glm::dvec3(4, 0, -3);
        const auto depth_mm = [](const glm::dvec3& p) { return ball_radius_mm - glm::length(p); };
        const double moved_mm = std::min(depth_mm(from_mm), from_mm.z - 5.0),
                     rest_mm = std::min(depth_mm(p_mm), 5.0 - p_mm.z);
        constexpr double clear_mm = 2.0;
        if (std::abs(moved_mm) < clear_mm || std::abs(rest_mm) < clear_mm) continue;
        const bool shows_moved = moved_mm > 0.0 && (is_moved_first || rest_mm < 0.0);
        if (!shows_moved && rest_mm < 0.0) continue;
        (shows_moved ? of_moved : of_rest)++;
        const auto tone = static_cast<unsigned char>(face.bytes[static_cast<std::size_t>(row * 96 + column)]);
        ASSERT_NEAR(tone, 255.0 * sample(shows_moved ? from_mm : p_mm) / 1400.0, 1.0)
            << both << " at " << column << ", " << row;
      }
    EXPECT_GT(of_moved, 300);
    EXPECT_GT(of_rest, 1000);
  }
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
           {R"("lights": ["0,0,1,0.5"], "diffuse": 0.5)", "every light states its strength"},
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
