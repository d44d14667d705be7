// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <array>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
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
  EXPECT_NE(testing::PrintToString(certificate.shared_values).find("register: values"), std::string::npos)
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

/// Three balls of different size and density on 40 x 40 x 40 samples of 3 mm, in a frame.
voxel::Scene three_balls(const glm::dmat4& moved_from_still) {
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({40, 40, 40}, {3, 3, 3}, {-58.5, -58.5, -58.5});
  const std::array<glm::dvec4, 3> balls{{{-15, 0, 5, 25}, {25, 12, -8, 16}, {5, -20, 32, 12}}};
  voxel::Int16Samples samples;
  for (int z = 0; z < 40; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        double value = -1000.0;
        for (std::size_t i = 0; i < balls.size(); ++i) {
          const double depth_mm =
              balls[i].w - glm::distance(glm::dvec3(balls[i]), scene.lattice.lps_mm({x, y, z}));
          value =
              std::max(value, std::clamp(200.0 * depth_mm, -1000.0, 300.0 + 400.0 * static_cast<double>(i)));
        }
        samples.push_back(static_cast<std::int16_t>(value));
      }
  scene.samples = std::move(samples);
  scene.meaning = voxel::Meaning::Hounsfield;
  scene.modality = "CT";
  scene.lattice.lps_from_voxel = moved_from_still * scene.lattice.lps_from_voxel;
  return scene;
}

TEST(RegisterStep, AnObjectFollowsItsScanOntoAnother) {
  const ScratchFolder folder;
  const glm::dmat4 moved = glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(8, -5, 3)), 0.15,
                                       glm::normalize(glm::dvec3(1, 2, 3)));
  voxel::write_scene(three_balls(glm::dmat4(1.0)), folder / "after.nrrd");
  voxel::write_scene(three_balls(moved), folder / "before.nrrd");
  const auto plan_with = [&](const std::string& steps) {
    return parse_plan(R"({"octotomy_plan": 1, "name": "two", "scans": {"before": {"path": "before.nrrd"},
        "after": {"path": "after.nrrd"}}, "universe": {"voxel_mm": 2.0}, "steps": [
        {"id": "was", "do": "window", "scan": "before", "low": 0}, {"id": "is", "do": "window", "scan": "after", "low": 0},
        )" + steps + "]}",
                      folder.path());
  };
  for (const char* by : {"correlation", "mutual_information"}) {
    const Evaluation evaluation =
        evaluate(plan_with(R"({"id": "laid", "do": "register", "object": "was", "onto": "is", "by": ")" +
                           std::string(by) + "\"}"));
    const Object &is = evaluation.object("is"), &laid = evaluation.object("laid");
    EXPECT_LT(
        glm::distance(*laid.mesh.within->measures().centroid_mm, *is.mesh.within->measures().centroid_mm),
        0.3)
        << by;
    ASSERT_TRUE(laid.moved);
    EXPECT_EQ(laid.mesh.details["verdict"], "PASS") << laid.mesh.details.dump();
    EXPECT_GT(laid.mesh.details["scans"]["likeness"].get<double>(), 0.5) << by;
  }
  const std::string same =
      R"({"id": "laid", "do": "register", "object": "is", "onto": "is", "by": "correlation"})";
  try {
    evaluate(plan_with(same));
    ADD_FAILURE() << "one scan was laid on itself";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("come from the same scan"), std::string::npos) << error.what();
  }
  const auto refusal = [&](const std::string& rest) {
    return ball_refusal(folder,
                        R"({"id": "l", "do": "register", "object": "ball", "onto": "ball")" + rest + "}");
  };
  EXPECT_NE(refusal(R"(, "by": "correlation", "overlap": 0.5)").find("only to surfaces"), std::string::npos);
  EXPECT_NE(refusal(R"(, "finest_mm": 4)").find("two scans"), std::string::npos);
  EXPECT_NE(refusal(R"(, "by": "guess")").find("mutual_information"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
