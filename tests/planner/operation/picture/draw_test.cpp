// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/view/draw.h"

#include <gtest/gtest.h>

#include "convert/surface/cuberille.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"
#include "voxel/solid/digitise.h"
#include "voxel/view/render.h"

namespace octotomy::planner {
namespace {

using namespace tests;

constexpr const char* ball_and_box = R"({"id": "half", "do": "mask", "regions": [{"view": "anterior",
    "polygons_mm": [[[-30, -30], [0, -30], [0, 30], [-30, 30]]]}]},
    {"id": "part", "do": "combine", "expression": "ball & half"}, )";

nlohmann::ordered_json drawn_details(const ScratchFolder& folder, const std::string& step) {
  const Plan plan = ball_plan(folder, ball_and_box + step);
  const Evaluation evaluation = evaluate(plan);
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  EXPECT_EQ(files.size(), 1u);
  EXPECT_TRUE(files[0].written) << testing::PrintToString(files[0].findings);
  return files[0].details;
}

TEST(DrawStep, SurfacesContoursAndSlicesOfAPlanStandInOnePicture) {
  const ScratchFolder folder;
  const auto said = drawn_details(folder, R"({"id": "d", "do": "draw", "objects": ["part"],
      "contours": ["ball"], "apart_mm": 4, "scan": "ct", "axial": [-8, 8], "window": "0:", "box": true,
      "within": "ball", "view": "35,15", "shading": "gouraud", "path": "facets.png"})");
  ASSERT_EQ(said["objects"].size(), 5u);
  EXPECT_EQ(said["objects"][0]["kind"], "surface");
  // The ball of radius 20 reaches nine multiples of 4 mm without its poles: their circles' length.
  double length_mm = 0.0;
  for (int z = -16; z <= 16; z += 4) length_mm += 2 * M_PI * std::sqrt(400.0 - z * z);
  EXPECT_NEAR(said["objects"][1]["length_mm"].get<double>() / length_mm, 1.0, 0.05);
  EXPECT_EQ(said["objects"][2]["kind"], "box");
  // A disc of the ball, 8 mm from its middle, in pixels of 1 mm.
  EXPECT_NEAR(said["objects"][3]["shown_pixels"].get<double>() / (M_PI * (400.0 - 64.0)), 1.0, 0.03);
  EXPECT_NEAR(said["objects"][4]["shown_pixels"].get<double>() / (M_PI * (400.0 - 64.0)), 1.0, 0.03);
  EXPECT_TRUE(std::filesystem::exists(folder / "facets.png"));
}

TEST(DrawStep, ALampOnTheOtherSideAndAPickedPixelAreReported) {
  const ScratchFolder folder;
  const auto said =
      drawn_details(folder, R"({"id": "d", "do": "draw", "objects": ["ball"], "light": [1, 0, 1],
      "ambient": 0, "gloss": 0.5, "size": "101x101", "width_mm": 50.5, "centre_mm": [0, 0, 0], "path": "d.png",
      "picks": ["50,50", "0,0"]})");
  EXPECT_NEAR(said["picks"][0]["point_mm"][1].get<double>(), -20.0, 0.6);
  EXPECT_NEAR(said["picks"][0]["point_mm"][0].get<double>(), 0.0, 1e-9);
  EXPECT_EQ(said["picks"][0]["object"], "ball");
  EXPECT_TRUE(said["picks"][1]["object"].is_null());
}

TEST(DrawStep, WhatCannotBeDrawnOrChangesNothingIsRefused) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& rest) {
    return ball_refusal(folder, R"({"id": "d", "do": "draw", "path": "d.png", )" + rest + "}");
  };
  const std::vector<std::pair<std::string, std::string>> refused{
      {R"("view": "front")", "nothing to draw"},
      {R"("scan": "ct")", "state their positions"},
      {R"("objects": ["ball"], "axial": [3])", "add 'scan'"},
      {R"("objects": ["ball"], "window": "0:")", "add 'scan'"},
      {R"("objects": ["ball"], "within": "ball")", "add 'scan'"},
      {R"("objects": ["ball"], "level": [3, 4])", "add 'scan'"},
      {R"("objects": ["ball"], "apart_mm": 3)", "sections of surfaces"},
      {R"("contours": ["ball"], "shading": "flat")", "surfaces: add a surface"},
      {R"("contours": ["ball"], "light": [1, 1, 1])", "shaded"},
      {R"("objects": ["ball"], "light": [0, 0, 0])", "no direction"},
      {R"("objects": ["ball"], "ambient": 2)", "from 0 to 1"},
      {R"("objects": ["ball"], "shading": "wire", "gloss": 0.2)", "shaded"},
      {R"("objects": ["ball"], "shading": "wire", "cull": true)", "'hide'"},
      {R"("objects": ["ball"], "hide": true)", "wire"},
      {R"("objects": ["ball"], "shading": "toon")", "gouraud"},
      {R"("objects": ["ball"], "colours": ["#ff0000", "#00ff00"])", "more colours"},
      {R"("objects": ["ball"], "title": "a")", "annotate"},
      {R"("objects": ["ball"], "grid_mm": 10, "eye_mm": 300)", "true scale"},
      {R"("objects": ["ball"], "view": "front")", "anterior"},
      {R"("objects": ["ball"], "size": "0x5")", "WxH"},
      {R"("contours": ["ball.json"])", "no earlier step"}};
  for (const auto& [step, word] : refused)
    EXPECT_NE(refusal(step).find(word), std::string::npos) << step << "\n" << refusal(step);
}

/// Pixels at which two renderers without common code differ.
struct Differences {
  int of_lit = 0, lit = 0;
  double depth_mm = 0.0;  ///< the largest, of pixels that both light
};

Differences compare(const voxel::Octree& octree, const brep::Triangles& triangles, const std::string& view) {
  voxel::RenderOptions of_voxels;
  of_voxels.view = voxel::parse_view(view);
  of_voxels.size_px = {300, 260};
  of_voxels.width_mm = 75.0;
  of_voxels.centre_mm = glm::dvec2(1.3, -2.7);
  of_voxels.algorithm = voxel::Algorithm::RayCast;
  const voxel::Picture voxels = voxel::render({{"box", octree}}, of_voxels);
  brep::DrawOptions of_facets;
  of_facets.camera = {of_voxels.view.right, of_voxels.view.up,
                      of_voxels.view.look,  of_voxels.size_px,
                      *of_voxels.centre_mm, 0.25,
                      voxels.nearest_mm,    {}};
  const brep::DrawnPicture facets = brep::draw({{{&triangles, glm::vec3(1.0f)}}, {}, {}}, of_facets);
  Differences differences;
  for (std::size_t i = 0; i < facets.item.size(); ++i) {
    const bool a = voxels.object[i] >= 0, b = facets.item[i] >= 0;
    differences.of_lit += a != b;
    differences.lit += a;
    if (a && b)
      differences.depth_mm =
          std::max<double>(differences.depth_mm, std::abs(voxels.depth_mm[i] - facets.depth_mm[i]));
  }
  return differences;
}

TEST(DrawFacets, AMeshAndItsOctreeLieOverEachOtherPixelByPixel) {
  voxel::Universe universe{6, glm::dmat4(1.0)};
  universe.lps_from_voxel[3] = glm::dvec4(-31.5, -31.5, -31.5, 1.0);
  const voxel::Octree octree = voxel::digitise(
      universe, voxel::Expression(voxel::Ellipsoid{{0, 0, 0}, {22, 12, 17}}), voxel::Digitisation::Centre);
  const brep::Triangles triangles = convert::triangles_of(convert::cuberille(octree));
  for (const char* view : {"anterior", "posterior", "left", "right", "superior", "inferior"}) {
    const Differences found = compare(octree, triangles, view);
    EXPECT_GT(found.lit, 4000) << view;
    EXPECT_EQ(found.of_lit, 0) << view;
    EXPECT_LT(found.depth_mm, 1e-3) << view;
  }
  for (const char* view : {"35,15", "-70,40"}) {
    const Differences found = compare(octree, triangles, view);
    EXPECT_GT(found.lit, 4000) << view;
    EXPECT_EQ(found.of_lit, 0) << view;
    EXPECT_LT(found.depth_mm, 1e-3) << view;
  }
  // A millimetre aside would show: the spoiled twin.
  brep::Triangles moved = triangles;
  for (glm::dvec3& p : moved.points_mm) p.x += 1.0;
  EXPECT_GT(compare(octree, moved, "anterior").of_lit, 100);
}

}  // namespace
}  // namespace octotomy::planner
