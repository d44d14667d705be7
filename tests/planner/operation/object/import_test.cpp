// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "brep/io/write_mesh.h"
#include "brep/mesh/triangles.h"
#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/brep/shapes.h"
#include "tests/brep/told.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(ImportStep, AMeshBesideThePlanCutsTheBallInBothKernels) {
  const ScratchFolder folder;
  brep::write_mesh(brep::mesh_of(brep::shapes::box({-30, -30, -5.0}, {30, 30, 30})), folder / "block.stl");
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "block", "do": "import", "path": "block.stl"},
      {"id": "rest", "do": "combine", "expression": "ball - block"})"));
  EXPECT_FALSE(evaluation.object("block").certificate);
  expect_not_independent(evaluation.object("rest"), cap_mm3(ball_radius_mm, 5.0), 0.05);
}

TEST(ImportStep, WhatTheFileSaysOfItsFrameAndWhatTheStepSaysOfItsUnitAreApplied) {
  const ScratchFolder folder;
  // The block above, turned to RAS and in metres, as text.
  std::ofstream file(folder / "block.obj");
  file << "# SPACE=RAS\n";
  const brep::Triangles block = brep::shapes::box({-30, -30, -5.0}, {30, 20, 30});
  for (const glm::dvec3& p : block.points_mm)
    file << "v " << -p.x / 1000.0 << " " << -p.y / 1000.0 << " " << p.z / 1000.0 << "\n";
  for (const auto& f : block.faces) file << "f " << f[0] + 1 << " " << f[1] + 1 << " " << f[2] + 1 << "\n";
  file.close();
  const Evaluation evaluation =
      evaluate(ball_plan(folder, R"({"id": "block", "do": "import", "path": "block.obj", "unit": "m"})"));
  const Object& made = evaluation.object("block");
  EXPECT_NEAR(made.mesh.whole->size().high_mm.y, 20.0, 1e-6);
  EXPECT_NEAR(made.mesh.whole->size().low_mm.y, -30.0, 1e-6);
  EXPECT_NEAR(made.mesh.whole->measures().volume_mm3, 60.0 * 50.0 * 35.0, 1e-3);
  ASSERT_EQ(made.findings.size(), 1U) << told(made.findings);
  EXPECT_NE(told(made.findings).find("no certificate"), std::string::npos) << told(made.findings);
  EXPECT_NE(made.mesh.details.at("audit").dump().find("SPACE=RAS"), std::string::npos);
}

TEST(ImportStep, AMeshThatIsAThousandTimesTooSmallIsToldWithTheUnitThatFits) {
  const ScratchFolder folder;
  brep::write_mesh(brep::mesh_of(brep::shapes::box({-0.03, -0.03, -0.005}, {0.03, 0.03, 0.03})),
                   folder / "block.stl");
  const Evaluation evaluation =
      evaluate(ball_plan(folder, R"({"id": "block", "do": "import", "path": "block.stl"})"));
  EXPECT_NE(told(evaluation.object("block").findings).find("try --unit m"), std::string::npos)
      << told(evaluation.object("block").findings);
}

TEST(ImportStep, APlanOfMeshesAloneHasItsUniverseAroundThemAllWithRoomForMotions) {
  const ScratchFolder folder;
  brep::write_mesh(brep::mesh_of(brep::shapes::box({-30, -30, -30}, {30, 30, 30})), folder / "block.stl");
  brep::write_mesh(brep::mesh_of(brep::shapes::box({0, 0, 0}, {40, 40, 40})), folder / "other.stl");
  const Plan plan =
      parse_plan(R"({"octotomy_plan": 1, "name": "meshes", "universe": {"voxel_mm": 1}, "steps": [
      {"id": "block", "do": "import", "path": "block.stl"},
      {"id": "other", "do": "import", "path": "other.stl"},
      {"id": "both", "do": "combine", "expression": "block & other"},
      {"id": "aside", "do": "move", "object": "both", "translate_mm": [0, 0, 25]}]})",
                 folder.path());
  const Evaluation evaluation = evaluate(plan);
  const voxel::Box box = voxel::bounds(evaluation.universe.lattice());
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(box.low_mm[axis], -30.0 - 30.0);
    EXPECT_GE(box.high_mm[axis], 40.0 + 30.0);
  }
  EXPECT_NEAR(evaluation.object("both").mesh.whole->measures().volume_mm3, 27000.0, 1e-6);
  ASSERT_TRUE(evaluation.object("both").certificate);
  EXPECT_NE(evaluation.object("both").certificate->verdict, verify::Verdict::Fail);
  EXPECT_NEAR(evaluation.object("aside").mesh.whole->size().high_mm.z, 55.0, 1e-9);
  EXPECT_TRUE(evaluation.scans.empty());
}

TEST(ImportStep, APlanWithoutScansAndWithoutAnImportIsRefused) {
  for (const char* scans : {"", R"("scans": {},)"}) {
    try {
      parse_plan(std::string(R"({"octotomy_plan": 1, "name": "nothing",)") + scans +
                     R"("steps": [{"id": "a", "do": "mask", "regions": [
          {"view": "anterior", "polygons_mm": [[[-9,-9],[9,-9],[9,9]]]}]}]})",
                 ".");
      FAIL() << scans;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("scans: must name at least one scan"), std::string::npos)
          << error.what();
    }
  }
}

TEST(ImportStep, AnUnknownFrameIsRefusedWhenThePlanIsRead) {
  const ScratchFolder folder;
  try {
    ball_plan(folder, R"({"id": "block", "do": "import", "path": "block.stl", "frame": "up"})");
    FAIL() << "was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("'up' is not a frame"), std::string::npos) << error.what();
  }
}

TEST(ImportStep, AFileThatIsNotThereIsNamed) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, R"({"id": "block", "do": "import", "path": "none.stl"})");
  try {
    evaluate(plan);
    FAIL() << "was read";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("none.stl"), std::string::npos) << error.what();
  }
}

TEST(ImportStep, AMovedMeshIsVoxelisedAnewAndIsWhatItIs) {
  const ScratchFolder folder;
  brep::write_mesh(brep::mesh_of(brep::shapes::box({-5, -5, -5}, {3.3, 3.3, 3.3})), folder / "cube.stl");
  const Plan plan = ball_plan(folder, R"(
      {"id": "cube", "do": "import", "path": "cube.stl"},
      {"id": "turned", "do": "move", "object": "cube", "rotate": {"degrees": 33, "axis": [1, 2, 0.5]}},
      {"id": "mirrored", "do": "mirror", "object": "cube", "normal": [1, 0.2, 0.3]},
      {"id": "rest", "do": "combine", "expression": "ball - turned"},
      {"id": "size", "do": "measure", "object": "turned"})");
  const Evaluation evaluation = evaluate(plan);
  for (const char* id : {"turned", "mirrored", "rest"}) {
    const auto& certificate = evaluation.object(id).certificate;
    ASSERT_TRUE(certificate) << id;
    EXPECT_NE(certificate->verdict, voxel::Verdict::Fail)
        << id << testing::PrintToString(certificate->reasons);
  }
  const Json size = measurements_json(plan, evaluation).at(0);
  EXPECT_NEAR(size.at("volume").at("value").get<double>(), 8.3 * 8.3 * 8.3, 0.01);
  EXPECT_NEAR(size.at("area").at("value").get<double>(), 6.0 * 8.3 * 8.3, 0.01);
  EXPECT_LT(size.at("volume").at("half_width").get<double>(), 0.01);
}

}  // namespace
}  // namespace octotomy::planner
