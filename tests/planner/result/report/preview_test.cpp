// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/preview.h"

#include <gtest/gtest.h>

#include "planner/operation/picture/removed_picture.h"
#include "tests/planner/ct_scene.h"
#include "tests/planner/operation/ball_operation.h"
#include "voxel/scan/image_file.h"

namespace octotomy::planner {
namespace {

using namespace tests;

Plan plan_in(const ScratchFolder& folder) {
  return ball_plan(folder, R"(
      {"id": "marks", "do": "landmarks", "points": [{"name": "front", "point_mm": [0, -20, 0]}]},
      {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "cap", "do": "combine", "expression": "ball & cut"},
      {"id": "moved", "do": "move", "object": "cap", "translate_mm": [0, 0, 3]},
      {"id": "off", "do": "combine", "expression": "ball - cut"},
      {"id": "size", "do": "measure", "object": "moved"})");
}

std::uint64_t voxels(const Preview& made, std::size_t object) {
  return made.objects.at(object).octree.voxel_count();
}

TEST(Preview, AMaskShowsWhatItHoldsOfTheBoneThatItCuts) {
  const ScratchFolder folder;
  const Plan plan = plan_in(folder);
  const Preview made = preview(plan, "cut");
  const Evaluation whole = evaluate(plan);
  ASSERT_EQ(made.objects.size(), 2u);
  EXPECT_EQ(voxels(made, 0), whole.object("off").voxel.octree.voxel_count());
  EXPECT_EQ(voxels(made, 1), whole.object("cap").voxel.octree.voxel_count());
  EXPECT_EQ(made.frames.size(), 3u);
  EXPECT_EQ(std::string(made.png.begin() + 1, made.png.begin() + 4), "PNG");
}

TEST(Preview, AMoveShowsTheMovedPieceAndWhatStaysAndEvaluatesNoMoreThanThat) {
  const ScratchFolder folder;
  const Preview made = preview(plan_in(folder), "moved");
  ASSERT_EQ(made.objects.size(), 2u);
  EXPECT_EQ(made.objects[1].name, "moved");
  EXPECT_NEAR(static_cast<double>(voxels(made, 0)), ball_mm3(20.0) - cap_mm3(20.0, 5.0), 700.0);
  EXPECT_EQ(made.evaluation.objects.size(), 4u) << "not 'off'";
  for (const Object& object : made.evaluation.objects) {
    EXPECT_FALSE(object.mesh.whole) << object.id;
    EXPECT_FALSE(object.certificate) << object.id;
  }
}

TEST(Preview, LandmarksAreBallsOnTheFirstPiece) {
  const ScratchFolder folder;
  const Preview made = preview(plan_in(folder), "marks");
  ASSERT_EQ(made.objects.size(), 2u);
  EXPECT_EQ(made.objects[1].name, "front");
  EXPECT_GT(voxels(made, 1), 20u);
}

TEST(Preview, AStepThatMakesAScanShowsInRedWhatItRemoves) {
  const ScratchFolder folder;
  // A head, and a board that hangs 20 mm behind it.
  voxel::write_scene(ct_scene({80, 90, 40}, {1, 1, 1}, {-39.5, -39.5, -19.5},
                              [](const glm::ivec3& /*at*/, const glm::dvec3& p) {
                                return glm::length(p) < 20 || (p.y > 40 && p.y < 46) ? 60 : -1000;
                              }),
                     folder / "ct.nrrd");
  const Plan plan = parse_plan(R"({"octotomy_plan": 1, "name": "n", "scans": {"ct": {"path": "ct.nrrd"}},
      "steps": [{"id": "head", "do": "remove_headrest", "scan": "ct"},
                {"id": "face", "do": "crop", "scan": "ct", "low_mm": [-25, -25, -15], "high_mm": [25, 25, 15]},
                {"id": "skin", "do": "window", "scan": "head", "low": 0}]})",
                               folder.path());
  const Preview made = preview(plan, "head");
  EXPECT_TRUE(made.objects.empty());
  const RemovedPicture picture =
      removed_picture(made.evaluation.loaded.at("ct")->scene(), made.evaluation.loaded.at("head")->scene());
  EXPECT_EQ(made.png, voxel::encode_image("png", picture.size_px, picture.rgb));
  EXPECT_NE(picture.rgb, removed_picture(made.evaluation.loaded.at("ct")->scene(),
                                         made.evaluation.loaded.at("ct")->scene())
                             .rgb);
  try {
    preview(plan, "face");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("'face'"), std::string::npos) << error.what();
  }
}

TEST(Preview, AStepThatIsNotThereIsRefusedWithTheNearest) {
  const ScratchFolder folder;
  try {
    preview(plan_in(folder), "mooved");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'moved'?"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace octotomy::planner
