// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Operations that write a file by one function for their verb and their step.
#include "planner/operation/file/step_on_files.h"

#include <gtest/gtest.h>

#include "brep/io/read_mesh.h"
#include "brep/mesh/measure.h"
#include "planner/plan/plan_results.h"
#include "tests/file_bytes.h"
#include "tests/planner/operation/ball_operation.h"
#include "voxel/measure/measure.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// The file of the one step that writes one, and the evaluation that it was written of.
struct Written {
  Evaluation evaluation;
  Exported file;
};

Written written(const ScratchFolder& folder, const std::string& steps) {
  const Plan plan = ball_plan(folder, steps);
  Written made{evaluate(plan), {}};
  Timings timings;
  std::vector<Exported> files = write_files(plan, made.evaluation, folder.path(), timings);
  EXPECT_EQ(files.size(), 1u);
  made.file = std::move(files.at(0));
  return made;
}

TEST(StepOnFiles, AnOctreeIsTheObjectsOwn) {
  const ScratchFolder folder;
  const Written made =
      written(folder, R"({"id": "tree", "do": "octree", "object": "ball", "path": "trees/ball.octree"})");
  ASSERT_TRUE(made.file.written);
  EXPECT_EQ(made.file.object, "ball");
  EXPECT_EQ(made.file.path, "trees/ball.octree");
  const voxel::OctreeFile read = voxel::read_octree(folder / "trees/ball.octree");
  EXPECT_EQ(std::get<voxel::Octree>(read.tree), made.evaluation.object("ball").voxel.octree);
  EXPECT_FALSE(made.file.details.contains("path"));
}

TEST(StepOnFiles, AnOctreesOtherFormIsThatOfItsFile) {
  const ScratchFolder folder;
  const Written made = written(
      folder, R"({"id": "tree", "do": "octree", "object": "ball", "as": "linear", "path": "ball.txt"})");
  ASSERT_TRUE(made.file.written);
  EXPECT_EQ(made.file.details.at("bytes_representation"), std::filesystem::file_size(folder / "ball.txt"));
}

TEST(StepOnFiles, ACuberilleHasTheVolumeOfItsVoxels) {
  const ScratchFolder folder;
  const Written made = written(
      folder, R"({"id": "m", "do": "mesh", "object": "ball", "surface": "cuberille", "path": "ball.off"})");
  ASSERT_TRUE(made.file.written);
  const double voxels_mm3 = made.evaluation.object("ball").voxel.measures.volume_mm3;
  EXPECT_NEAR(made.file.details.at("volume_mm3").get<double>(), voxels_mm3, 1e-6 * voxels_mm3);
  EXPECT_NEAR(brep::size_of(brep::read_triangles(folder / "ball.off")).volume_mm3, voxels_mm3,
              1e-6 * voxels_mm3);
}

TEST(StepOnFiles, VoxelsOfAMeshLieInThePlansUniverse) {
  const ScratchFolder folder;
  const Written made =
      written(folder, R"({"id": "v", "do": "voxelise", "meshes": ["ball"], "path": "ball.octree"})");
  ASSERT_TRUE(made.file.written);
  const voxel::OctreeFile read = voxel::read_octree(folder / "ball.octree");
  const auto& octree = std::get<voxel::Octree>(read.tree);
  EXPECT_EQ(octree.universe(), made.evaluation.universe);
  EXPECT_NEAR(voxel::measure(octree).volume_mm3, ball_mm3(ball_radius_mm), 0.01 * ball_mm3(ball_radius_mm));
}

TEST(StepOnFiles, AFindingNamesAFileWithinTheResult) {
  const ScratchFolder folder;
  const Written made =
      written(folder, R"({"id": "v", "do": "voxelise", "meshes": ["ball"], "path": "maps/ball.nrrd"})");
  ASSERT_TRUE(made.file.written);
  ASSERT_EQ(made.file.findings.size(), 1u);
  EXPECT_NE(made.file.findings.front().find(" maps/ball.tsv"), std::string::npos)
      << made.file.findings.front();
}

TEST(StepOnFiles, AnExpressionsOctreeIsThatOfCombine) {
  const ScratchFolder folder;
  const Written made = written(folder, ball_caps(R"(
      {"id": "cap", "do": "combine", "expression": "ball & high"},
      {"id": "e", "do": "eval", "expression": "ball & high", "path": "cap.octree"})"));
  ASSERT_TRUE(made.file.written) << made.file.findings.front();
  EXPECT_EQ(std::get<voxel::Octree>(voxel::read_octree(folder / "cap.octree").tree),
            made.evaluation.object("cap").voxel.octree);
}

TEST(StepOnFiles, AnExpressionsMotionIsOfTheStep) {
  const ScratchFolder folder;
  const Written made = written(folder, R"plan({"id": "e", "do": "eval", "expression": "move(ball, up)",
      "motions": ["up=0,0,3"], "path": "up.octree"})plan");
  ASSERT_TRUE(made.file.written) << made.file.findings.front();
  const voxel::Measures up =
      voxel::measure(std::get<voxel::Octree>(voxel::read_octree(folder / "up.octree").tree));
  EXPECT_NEAR(up.centroid_mm->z - made.evaluation.object("ball").voxel.measures.centroid_mm->z, 3.0, 0.05);
  EXPECT_NE(ball_refusal(folder, R"plan({"id": "e", "do": "eval", "expression": "move(ball, up)",
      "path": "up.octree"})plan")
                .find("no motion is called 'up'"),
            std::string::npos);
}

TEST(StepOnFiles, TetrahedraOfItsVoxelsFillThemAll) {
  const ScratchFolder folder;
  const Written made =
      written(folder, R"({"id": "t", "do": "tet", "object": "ball", "of_voxels": true, "path": "ball.vtu"})");
  ASSERT_TRUE(made.file.written) << made.file.findings.front();
  const double voxels_mm3 = made.evaluation.object("ball").voxel.measures.volume_mm3;
  EXPECT_NEAR(made.file.details.at("volume_mm3").get<double>(), voxels_mm3, 1e-6 * voxels_mm3);
}

TEST(StepOnFiles, WhatCannotBeWrittenIsAFindingAndNoFile) {
  const ScratchFolder folder;
  const Written made = written(folder, ball_caps(R"(
      {"id": "none", "do": "combine", "expression": "ball - ball"},
      {"id": "m", "do": "mesh", "object": "none", "path": "none.off"})"));
  EXPECT_FALSE(made.file.written);
  ASSERT_EQ(made.file.findings.size(), 1u);
  EXPECT_EQ(made.file.findings.front(), "not written: none: nothing is in it");
  EXPECT_FALSE(std::filesystem::exists(folder / "none.off"));
}

TEST(StepOnFiles, AnOutputOfAnotherKindOrOutsideOfTheResultIsRefused) {
  const ScratchFolder folder;
  for (const char* step : {R"({"id": "t", "do": "octree", "object": "ball", "path": "ball.stl"})",
                           R"({"id": "t", "do": "octree", "object": "ball", "path": "../ball.octree"})",
                           R"({"id": "t", "do": "mesh", "object": "ball", "path": "ball.octree"})",
                           R"({"id": "t", "do": "voxelise", "meshes": ["ball"], "path": "ball.off"})",
                           R"({"id": "t", "do": "tet", "object": "ball", "path": "ball.off"})",
                           R"({"id": "t", "do": "eval", "expression": "ball", "path": "ball.nrrd"})"})
    EXPECT_NE(ball_refusal(folder, step).find("path"), std::string::npos) << step;
}

}  // namespace
}  // namespace octotomy::planner
