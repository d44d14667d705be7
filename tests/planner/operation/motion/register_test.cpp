// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>

#include "tests/brep/told.h"
#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// An egg, whose place and axis a fit can find, and the egg moved.
constexpr const char* egg = R"(
    {"id": "a", "do": "mask", "regions": [{"view": "anterior",
      "polygons_mm": [[[-30, -30], [4, -30], [11, 30], [-30, 30]]]}]},
    {"id": "b", "do": "mask", "regions": [{"view": "left",
      "polygons_mm": [[[-30, -30], [9, -30], [2, 30], [-30, 30]]]}]},
    {"id": "egg", "do": "combine", "expression": "ball & a & b"},
    {"id": "off", "do": "move", "object": "egg", "translate_mm": [1.5, -2, 1],
      "rotate": {"degrees": 8, "axis": [0, 1, 1]}})";

TEST(RegisterStep, AMovedObjectIsLaidBackOnItsOriginInBothKernels) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(
      folder, std::string(egg) +
                  R"(, {"id": "back", "do": "register", "object": "off", "onto": "egg", "overlap": 1})"));
  const Object &still = evaluation.object("egg"), &back = evaluation.object("back");
  expect_certified(back, still.mesh.within->measures().volume_mm3, 0.02);
  EXPECT_LT(
      glm::distance(*back.mesh.within->measures().centroid_mm, *still.mesh.within->measures().centroid_mm),
      0.05);
  EXPECT_LT(glm::distance(*back.voxel.measures.centroid_mm, *still.voxel.measures.centroid_mm), 0.2);
  EXPECT_LT(back.mesh.details["rms_mm"].get<double>(), 0.05);
  ASSERT_TRUE(back.moved);
  EXPECT_EQ(back.moved->object, "off");
}

TEST(RegisterStep, AnotherMotionAPartLostASurfacePushedOutAndNothingFail) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, std::string(egg) + R"(,
      {"id": "back", "do": "register", "object": "off", "onto": "egg", "overlap": 1},
      {"id": "further", "do": "move", "object": "back", "translate_mm": [0.5, 0.5, 0]},
      {"id": "turned", "do": "move", "object": "back",
        "rotate": {"degrees": 3, "axis": [1, 0, 0], "about_mm": [0, 0, 0]}},
      {"id": "half", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, -30], [30, -30], [30, 12], [-30, 12]]]}]},
      {"id": "part_lost", "do": "combine", "expression": "back & half"},
      {"id": "wider", "do": "offset", "object": "back", "by_mm": 1})"));
  const verify::Certificate& certificate = *evaluation.object("back").certificate;
  EXPECT_EQ(verify::to_string(certificate.verdict), "PASS") << testing::PrintToString(certificate.reasons);
  ASSERT_TRUE(certificate.limit);
  EXPECT_LE(*certificate.limit->shift_mm, 0.5);
  for (const char* by : {"off", "further", "turned", "part_lost", "wider", ""})
    expect_fails_as(evaluation, "back", by);
}

/// Both kernels move by the one motion that the step found, so that an error of it is none of their
/// difference. The certificate names it.
TEST(RegisterStep, TheCertificateNamesTheMotionThatBothKernelsShare) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(
      folder, std::string(egg) +
                  R"(, {"id": "back", "do": "register", "object": "off", "onto": "egg", "overlap": 1})"));
  const verify::Certificate& certificate = *evaluation.object("back").certificate;
  EXPECT_NE(
      testing::PrintToString(certificate.shared_values).find("register: values that the step finds once"),
      std::string::npos)
      << testing::PrintToString(certificate.shared_values);
  EXPECT_TRUE(certificate.independent());
  EXPECT_TRUE(certificate.third) << "nothing was measured along lines";
}

TEST(RegisterStep, LandmarksThatLieAboutGiveTheirMotionAndTheCertificateJudgesThatMotion) {
  const ScratchFolder folder;
  std::ofstream(folder / "here.json") << R"({"landmarks": [{"name": "a", "point_mm": [0, 0, 0]},
      {"name": "b", "point_mm": [10, 0, 0]}, {"name": "c", "point_mm": [0, 10, 0]}]})";
  std::ofstream(folder / "there.json") << R"({"landmarks": [{"name": "a", "point_mm": [4, 0, 3]},
      {"name": "b", "point_mm": [14, 0, 3]}, {"name": "c", "point_mm": [4, 10, 3]}]})";
  const Evaluation evaluation = evaluate(ball_plan(folder, std::string(egg) + R"(,
      {"id": "up", "do": "register", "object": "egg", "onto": "ball",
        "landmarks": ["here.json", "there.json"], "landmarks_only": true},
      {"id": "same", "do": "move", "object": "egg", "translate_mm": [4, 0, 3]},
      {"id": "lower", "do": "move", "object": "egg", "translate_mm": [4, 0, 2.5]})"));
  EXPECT_EQ(verify::to_string(evaluation.object("up").certificate->verdict), "PASS")
      << testing::PrintToString(evaluation.object("up").certificate->reasons);
  EXPECT_EQ(verify::to_string(altered_certificate(evaluation, "up", "same").verdict), "PASS");
  for (const char* by : {"egg", "lower"}) expect_fails_as(evaluation, "up", by);
}

TEST(RegisterStep, LandmarksAloneGiveTheMotion) {
  const ScratchFolder folder;
  std::ofstream(folder / "here.json") << R"({"landmarks": [{"name": "a", "point_mm": [0, 0, 0]},
      {"name": "b", "point_mm": [10, 0, 0]}, {"name": "c", "point_mm": [0, 10, 0]}]})";
  std::ofstream(folder / "there.json") << R"({"landmarks": [{"name": "a", "point_mm": [0, 0, 3]},
      {"name": "b", "point_mm": [10, 0, 3]}, {"name": "c", "point_mm": [0, 10, 3]}]})";
  const Evaluation evaluation = evaluate(ball_plan(folder, R"({"id": "up", "do": "register", "object": "ball",
      "onto": "ball", "landmarks": ["here.json", "there.json"], "landmarks_only": true})"));
  EXPECT_NEAR(evaluation.object("up").mesh.within->measures().centroid_mm->z, 3.0, 1e-3);
  EXPECT_NEAR(evaluation.object("up").voxel.measures.centroid_mm->z, 3.0, 0.05);
}

TEST(RegisterStep, LandmarksThatFitMirroredAreTold) {
  const ScratchFolder folder;
  const auto write = [&](const char* name, int side) {
    std::ofstream(folder / name) << R"({"landmarks": [{"name": "nasion", "point_mm": [0, -90, 30]},
      {"name": "pogonion", "point_mm": [0, -85, -70]}, {"name": "left", "point_mm": [)"
                                 << 50 * side << R"(, -20, 10]}, {"name": "right", "point_mm": [)"
                                 << -55 * side << R"(, -22, 5]}]})";
  };
  write("here.json", 1);
  for (const int side : {1, -1}) {
    write("there.json", side);
    const Evaluation evaluation =
        evaluate(ball_plan(folder, R"({"id": "up", "do": "register", "object": "ball",
      "onto": "ball", "landmarks": ["here.json", "there.json"], "landmarks_only": true})"));
    EXPECT_EQ(told(evaluation.object("up").findings).find("mirrored") != std::string::npos, side < 0);
  }
}

TEST(RegisterStep, AScaleIsRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "r", "do": "register", "object": "ball", "onto": "ball",
      "motion": "similarity"})")
                .find("scales"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
