// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "brep/io/write_mesh.h"
#include "brep/mesh/triangles.h"
#include "tests/brep/shapes.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(RepairStep, AMeshWithAHoleAndATurnedTriangleBecomesAnObject) {
  const ScratchFolder folder;
  brep::Triangles box = brep::shapes::box({-30, -30, -5.0}, {30, 30, 30});
  box.faces.pop_back();
  std::swap(box.faces[0][1], box.faces[0][2]);
  brep::write_mesh(brep::mesh_of(brep::Triangles{box.points_mm, {box.faces.begin() + 1, box.faces.end()}}),
                   folder / "open.off");
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "block", "do": "repair", "path": "open.off", "holes": true},
      {"id": "rest", "do": "combine", "expression": "ball - block"})"));
  EXPECT_GE(evaluation.object("block").mesh.details["changes"].size(), 1u);
  expect_not_independent(evaluation.object("rest"), cap_mm3(ball_radius_mm, 5.0), 0.05);
}

TEST(RepairStep, ARepairThatIsAskedForNothingOrLeavesAHoleIsRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "r", "do": "repair", "path": "open.off"})").find("'weld_mm'"),
            std::string::npos);
  brep::Triangles box = brep::shapes::box({-3, -3, -3}, {3, 3, 3});
  box.faces.pop_back();
  brep::write_mesh(brep::mesh_of(box), folder / "open.off");
  try {
    evaluate(ball_plan(folder, R"({"id": "r", "do": "repair", "path": "open.off", "orient": true})"));
    FAIL() << "was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("still not a solid"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace octotomy::planner
