// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "brep/io/write_mesh.h"
#include "brep/mesh/triangles.h"
#include "tests/brep/shapes.h"
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
  expect_certified(evaluation.object("rest"), cap_mm3(ball_radius_mm, 5.0), 0.05);
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

}  // namespace
}  // namespace octotomy::planner
