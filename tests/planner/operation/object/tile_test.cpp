// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/tile.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>

#include "planner/plan/plan_results.h"
#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

std::string circle(double radius_mm, double u_mm = 0.0, int points = 180) {
  std::string text = "[";
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    text += (i > 0 ? ", [" : "[") + std::to_string(u_mm + radius_mm * std::cos(angle)) + ", " +
            std::to_string(radius_mm * std::sin(angle)) + "]";
  }
  return text + "]";
}

std::string slice(double position_mm, const std::string& polygons) {
  return R"({"position_mm": )" + std::to_string(position_mm) + R"(, "polygons_mm": [)" + polygons + "]}";
}

std::string tile(const std::string& contours, const std::string& more = "") {
  return R"({"id": "t", "do": "tile", "contours": [)" + contours + "]" + more + "}";
}

/// A frustum, and the cylinders at its ends.
double frustum_mm3(double low_mm, double high_mm, double height_mm, double end_mm) {
  const double pi = std::numbers::pi;
  return pi * height_mm / 3.0 * (low_mm * low_mm + low_mm * high_mm + high_mm * high_mm) +
         pi * end_mm * (low_mm * low_mm + high_mm * high_mm);
}

const std::string cone = slice(-8.0, circle(12.2)) + ", " + slice(8.0, circle(6.4));

TEST(TileStep, TwoCirclesAreAFrustumInBothKernels) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, tile(cone, R"(, "end_mm": 4)")));
  const Object& tiled = evaluation.object("t");
  expect_certified(tiled, frustum_mm3(12.2, 6.4, 16.0, 4.0), 0.01);
  EXPECT_EQ(tiled.definition, "2 contours in view inferior, tiled");
  EXPECT_EQ(tiled.mesh.lineage, "tiles between contours");
  EXPECT_GE(tiled.mesh.details["tiled_sections"].get<int>(), 17);
}

TEST(TileStep, APlanOfContoursAloneNeedsNoScan) {
  const ScratchFolder folder;
  const Plan plan =
      parse_plan(R"({"octotomy_plan": 1, "name": "p", "universe": {"voxel_mm": 0.5}, "steps": [)" +
                     tile(cone, R"(, "end_mm": 4)") + "]}",
                 folder.path());
  const Evaluation evaluation = evaluate(plan);
  expect_certified(evaluation.object("t"), frustum_mm3(12.2, 6.4, 16.0, 4.0), 0.01);
  const voxel::Box box = tile_box(plan.steps[0].action, folder.path());
  glm::dvec3 low_mm(1e9), high_mm(-1e9);
  for (const glm::dvec3& p : evaluation.object("t").mesh.within->triangles().points_mm) {
    low_mm = glm::min(low_mm, p);
    high_mm = glm::max(high_mm, p);
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(box.low_mm[axis], low_mm[axis], 0.05);
    EXPECT_NEAR(box.high_mm[axis], high_mm[axis], 0.05);
  }
}

TEST(TileStep, AnObliqueViewTurnsTheFrustum) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, tile(cone, R"(, "end_mm": 4, "view": "35,15")")));
  const Object& tiled = evaluation.object("t");
  expect_certified(tiled, frustum_mm3(12.2, 6.4, 16.0, 4.0), 0.01);
  // The wide end lies against the direction of sight.
  const glm::dvec3 look = voxel::parse_view("35,15").look;
  ASSERT_TRUE(tiled.mesh.within->measures().centroid_mm);
  EXPECT_LT(glm::dot(*tiled.mesh.within->measures().centroid_mm, look), -2.0);
}

TEST(TileStep, AHoleAndABranchAreTiledAlike) {
  const ScratchFolder folder;
  const std::string ring =
      slice(-9.0, circle(14.1) + ", " + circle(7.3)) + ", " + slice(-1.0, circle(15.2) + ", " + circle(8.3));
  const Evaluation hollow = evaluate(ball_plan(folder, tile(ring, R"(, "end_mm": 4)")));
  const double pi = std::numbers::pi;
  expect_certified(hollow.object("t"), frustum_mm3(14.1, 15.2, 8.0, 4.0) - frustum_mm3(7.3, 8.3, 8.0, 4.0),
                   0.015);
  const std::string branch =
      slice(-9.0, circle(14.1)) + ", " + slice(7.0, circle(6.2, -9.3) + ", " + circle(6.2, 9.3));
  const Evaluation branching = evaluate(ball_plan(folder, tile(branch)));
  const Object& tiled = branching.object("t");
  ASSERT_TRUE(tiled.certificate);
  EXPECT_NE(verify::to_string(tiled.certificate->verdict), "FAIL")
      << testing::PrintToString(tiled.certificate->reasons);
  // Half a gap of the wide contour, half a gap of the two at the other end, and at most the wide one between.
  EXPECT_GT(tiled.mesh.within->measures().volume_mm3, pi * 8.0 * (14.1 * 14.1 + 2.0 * 6.2 * 6.2));
  EXPECT_LT(tiled.mesh.within->measures().volume_mm3, pi * 8.0 * (3.0 * 14.1 * 14.1 + 2.0 * 6.2 * 6.2));
}

TEST(TileStep, NearestGoesStraightOnHalfWay) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, tile(cone, R"(, "end_mm": 4, "between": "nearest")")));
  const double pi = std::numbers::pi;
  expect_certified(evaluation.object("t"), pi * 12.0 * (12.2 * 12.2 + 6.4 * 6.4), 0.015);
}

TEST(TileStep, OneContourReachesAsFarAsItSays) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, tile(slice(0.0, circle(10.3)), R"(, "end_mm": 6)")));
  expect_certified(evaluation.object("t"), std::numbers::pi * 10.3 * 10.3 * 12.0, 0.015);
}

TEST(TileStep, ContoursOfAnObjectTileThatObjectAgain) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(
      folder,
      R"({"id": "lines", "do": "outline", "object": "ball", "view": "left", "every_mm": 1.5, "path": "l.json"})");
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluate(plan), folder.path(), timings);
  ASSERT_EQ(files.size(), 1u);
  ASSERT_TRUE(files[0].written) << testing::PrintToString(files[0].findings);
  const Evaluation again = evaluate(ball_plan(folder, R"({"id": "t", "do": "tile", "slices": "l.json"})"));
  expect_certified(again.object("t"), ball_mm3(ball_radius_mm), 0.01);
}

TEST(TileStep, AnAlteredAnswerOfEitherKernelFails) {
  const ScratchFolder folder;
  const std::string smaller = slice(-8.0, circle(9.2)) + ", " + slice(8.0, circle(6.4));
  std::string other = tile(smaller, R"(, "end_mm": 4)");
  other.replace(other.find(R"("t")"), 3, R"("other")");
  const Evaluation evaluation = evaluate(ball_plan(folder, tile(cone, R"(, "end_mm": 4)") + ", " + other));
  expect_fails_as(evaluation, "t", "other");
}

TEST(TileStep, WhatCannotBeTiledIsRefusedInALine) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& contours, const std::string& more = "") {
    return ball_refusal(folder, tile(contours, more));
  };
  const std::string good = slice(0.0, circle(5.0)) + ", " + slice(4.0, circle(5.0));
  const auto expect = [](const std::string& said, const std::string& part) {
    EXPECT_NE(said.find(part), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  };
  expect(ball_refusal(folder, R"({"id": "t", "do": "tile"})"), "'contours' is missing");
  expect(refusal(good, R"(, "slices": "a.json")"), "leave 'contours' out");
  expect(refusal(slice(0.0, circle(5.0))), "'end_mm'");
  expect(refusal(slice(0.0, "")), "end_mm");
  expect(refusal(slice(0.0, "") + ", " + slice(1.0, "")), "have no polygon");
  expect(refusal(good, R"(, "view": "sideways")"), "sideways");
  expect(refusal(good, R"(, "end_mm": 0)"), "end_mm");
  expect(refusal(good, R"(, "structure": "Jaw")"), "add the set as 'slices'");
  expect(refusal(slice(0.0, circle(5.0)) + ", " + slice(0.0, circle(4.0))),
         "contours[1], position_mm: is that of contours[0], too");
  expect(refusal(slice(0.0, "[[0, 0], [9, 9], [9, 0], [0, 9]]") + ", " + slice(4.0, circle(5.0))),
         "polygons_mm[0]: crosses itself");
  expect(refusal(slice(0.0, circle(5.0) + ", " + circle(5.0, 6.0)) + ", " + slice(4.0, circle(5.0))),
         "crosses itself or another contour");
  expect(refusal(slice(0.0, circle(5.0) + ", " + circle(5.0)) + ", " + slice(4.0, circle(5.0))), "repeats");
  expect(refusal(slice(0.0, "[[0, 0], [9, 9]]") + ", " + slice(4.0, circle(5.0))), "contours");
}

TEST(TileStep, ContoursWithoutAVoxelAreRefused) {
  const ScratchFolder folder;
  EXPECT_NE(made_refusal(folder, tile(slice(300.0, circle(5.0)) + ", " + slice(304.0, circle(5.0))))
                .find("enclose no voxel's centre"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
