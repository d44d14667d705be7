// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "planner/operation/anatomy/movement.h"
#include "planner/operation/table/deformation.h"
#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "planner/result/outcome/outcome.h"
#include "tests/planner/operation/altered.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// Area of an ellipsoid by Simpson's rule over its parameters.
double ellipsoid_mm2(const glm::dvec3& half_mm) {
  constexpr int steps = 400;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= steps; ++j) {
      const double u = M_PI * i / steps, v = 2.0 * M_PI * j / steps;
      const double weight = (i % steps == 0 ? 1
                             : i % 2 == 1   ? 4
                                            : 2) *
                            (j % steps == 0 ? 1
                             : j % 2 == 1   ? 4
                                            : 2);
      const glm::dvec3 n(half_mm.y * half_mm.z * std::sin(u) * std::cos(v),
                         half_mm.x * half_mm.z * std::sin(u) * std::sin(v),
                         half_mm.x * half_mm.y * std::cos(u));
      sum += weight * std::sin(u) * glm::length(n);
    }
  return sum * (M_PI / steps) * (2.0 * M_PI / steps) / 9.0;
}

Json measured_of(const std::string& steps, const std::vector<std::string>& names) {
  const ScratchFolder folder;
  std::string text = steps;
  for (const std::string& name : names)
    text += R"(, {"id": "size_)" + name + R"(", "do": "measure", "object": ")" + name + "\"}";
  const Plan plan = ball_plan(folder, text);
  return measurements_json(plan, evaluate(plan));
}

TEST(Affine, ABallScaledAboutItsCentreIsTheEllipsoidInBothKernels) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "egg", "do": "affine", "object": "ball", "scale": [1.4, 0.8, 1.1], "about_mm": [0, 0, 0]})"));
  const Object& egg = evaluation.object("egg");
  expect_certified(egg, 1.4 * 0.8 * 1.1 * ball_mm3(ball_radius_mm), 0.005);
  const brep::Measures& mesh = egg.mesh.within->measures();
  const glm::dvec3 half_mm = ball_radius_mm * glm::dvec3(1.4, 0.8, 1.1);
  EXPECT_LT(glm::distance(mesh.high_mm, half_mm), 0.05);
  EXPECT_NEAR(mesh.area_mm2 / ellipsoid_mm2(half_mm), 1.0, 0.005);
  EXPECT_NEAR(egg.voxel.measures.area_crofton13_mm2 / ellipsoid_mm2(half_mm), 1.0, 0.02);
  ASSERT_TRUE(egg.moved);
  EXPECT_FALSE(is_rigid(egg.moved->motion));
  const std::string findings = testing::PrintToString(egg.findings);
  EXPECT_NE(findings.find("no rigid motion: volumes change by the factor 1.23, lengths by 0.800 to 1.40"),
            std::string::npos)
      << findings;
}

TEST(Affine, AShearedBoxHasItsParallelepiped) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "front", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-9, -8], [9, -8], [9, 8], [-9, 8]]]},
        {"view": "left", "polygons_mm": [[[-7, -10], [7, -10], [7, 10], [-7, 10]]]}]},
      {"id": "box", "do": "combine", "expression": "ball & front"},
      {"id": "leaning", "do": "affine", "object": "box", "about_mm": [0, 0, -8],
       "shear": {"by": 0.5, "along": [1, 0, 0], "normal": [0, 0, 1]}})"));
  const Object &box = evaluation.object("box"), &leaning = evaluation.object("leaning");
  // 18 x 14 x 16 mm; its corners are 13.9 mm from the ball's centre, within 20.
  expect_certified(box, 18.0 * 14.0 * 16.0, 0.03);
  expect_certified(leaning, 18.0 * 14.0 * 16.0, 0.03);
  const brep::Size& size = leaning.mesh.within->size();
  EXPECT_NEAR(size.volume_mm3, 18.0 * 14.0 * 16.0, 1e-6);
  EXPECT_NEAR(size.area_mm2, 2.0 * (18.0 * 14.0 + 18.0 * 16.0 + 14.0 * std::hypot(16.0, 8.0)), 1e-6);
  EXPECT_LT(glm::distance(size.low_mm, glm::dvec3(-9, -7, -8)), 1e-9);
  EXPECT_LT(glm::distance(size.high_mm, glm::dvec3(17, 7, 8)), 1e-9);
}

TEST(Affine, TheInverseMapBringsBothKernelsBack) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "egg", "do": "affine", "object": "upper",
       "matrix": [[1.25, 0.5, 0, 1], [0, 0.8, 0, 2], [0, 0, 1, -3], [0, 0, 0, 1]]},
      {"id": "back", "do": "affine", "object": "egg",
       "matrix": [[0.8, -0.5, 0, 0.2], [0, 1.25, 0, -2.5], [0, 0, 1, 3], [0, 0, 0, 1]]})")));
  const Object &back = evaluation.object("back"), &upper = evaluation.object("upper");
  EXPECT_TRUE(back.voxel.octree == upper.voxel.octree);
  EXPECT_NEAR(back.mesh.whole->size().volume_mm3, upper.mesh.whole->size().volume_mm3, 1e-8);
  ASSERT_TRUE(back.image);
  EXPECT_TRUE(is_rigid(back.image->image_from_object));
  EXPECT_EQ(verify::to_string(back.certificate->verdict), "PASS");
}

TEST(Affine, AnotherFactorAnotherPointAPartLostASurfacePushedOutAndNothingFail) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "egg", "do": "affine", "object": "upper", "scale": [1.3, 0.9, 0.7], "about_mm": [0, 0, 5]},
      {"id": "other_factor", "do": "affine", "object": "upper", "scale": [1.4, 0.9, 0.7], "about_mm": [0, 0, 5]},
      {"id": "other_point", "do": "affine", "object": "upper", "scale": [1.3, 0.9, 0.7], "about_mm": [0, 0, 8]},
      {"id": "half", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, -30], [8, -30], [8, 30], [-30, 30]]]}]},
      {"id": "part_lost", "do": "combine", "expression": "egg & half"},
      {"id": "wider", "do": "offset", "object": "egg", "by_mm": 1})")));
  EXPECT_EQ(verify::to_string(evaluation.object("egg").certificate->verdict), "PASS")
      << testing::PrintToString(evaluation.object("egg").certificate->reasons);
  for (const char* by : {"upper", "other_factor", "other_point", "part_lost", "wider", ""})
    expect_fails_as(evaluation, "egg", by);
}

TEST(Affine, TheRecommendedVolumeAndItsIntervalChangeByTheDeterminant) {
  const Json sizes = measured_of(R"({"id": "egg", "do": "affine", "object": "ball", "scale": [1.4, 0.8, 1.1],
        "about_mm": [0, 0, 0]}, {"id": "moved", "do": "move", "object": "egg", "translate_mm": [0.3, 0.2, 0.1]})",
                                 {"ball", "egg", "moved"});
  const auto number = [&](std::size_t row, const char* quantity, const char* key) {
    return sizes[row][quantity][key].get<double>();
  };
  const double factor = 1.4 * 0.8 * 1.1;
  for (const std::size_t row : {std::size_t{1}, std::size_t{2}}) {
    EXPECT_NEAR(number(row, "volume", "value") / number(0, "volume", "value"), factor, 1e-12);
    EXPECT_NEAR(number(row, "volume", "half_width") / number(0, "volume", "half_width"), factor, 1e-12);
    EXPECT_NEAR(number(row, "volume", "value"), factor * ball_mm3(ball_radius_mm),
                number(row, "volume", "half_width"));
    EXPECT_NEAR(number(row, "area", "value"), ellipsoid_mm2(ball_radius_mm * glm::dvec3(1.4, 0.8, 1.1)),
                number(row, "area", "half_width"));
  }
}

TEST(Affine, AnObjectMadeOfAScaledOneHasTheIntervalOfItsOwnSurface) {
  const Json sizes = measured_of(R"({"id": "egg", "do": "affine", "object": "ball", "scale": [1.4, 0.8, 1.1],
        "about_mm": [0, 0, 0]}, {"id": "high", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-40, 0], [40, 0], [40, 30], [-40, 30]]]}]},
      {"id": "half", "do": "combine", "expression": "egg & high"})",
                                 {"egg", "half"});
  const double truth = 0.5 * 1.4 * 0.8 * 1.1 * ball_mm3(ball_radius_mm);
  const Json& volume = sizes[1]["volume"];
  EXPECT_NEAR(volume["value"].get<double>(), truth, volume["half_width"].get<double>());
  EXPECT_LT(volume["half_width"].get<double>(), 0.05 * truth);
  EXPECT_GT(volume["half_width"].get<double>(), 0.3 * sizes[0]["volume"]["half_width"].get<double>());
}

TEST(Affine, LandmarksAndDecksFollowAndMovementsStateThatItIsNotRigid) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, ball_caps(R"(
      {"id": "marks", "do": "landmarks", "points": [{"name": "top", "point_mm": [0, 0, 20]}]},
      {"id": "taller", "do": "affine", "object": "upper", "scale": [1, 1, 1.2], "about_mm": [0, 0, 5]},
      {"id": "then", "do": "move", "object": "taller", "translate_mm": [0, 0, 1]},
      {"id": "to_top", "do": "move", "object": "lower", "from": [0, 0, 0], "to": "top@then"})"));
  const Evaluation evaluation = evaluate(plan);
  // 5 + 1.2 * 15 + 1
  EXPECT_NEAR(evaluation.object("to_top").moved->motion[3].z, 24.0, 1e-12);
  const Json movements = movements_json(evaluation.objects, plan.landmarks);
  ASSERT_EQ(movements.size(), 3u);
  EXPECT_EQ(movements[0]["object"], "taller");
  EXPECT_EQ(movements[0]["is_rigid"], false);
  EXPECT_NEAR(movements[0]["volume_factor"].get<double>(), 1.2, 1e-12);
  EXPECT_NEAR(movements[0]["pitch_deg"].get<double>(), 0.0, 1e-9);
  EXPECT_NE(movements[0]["words"].get<std::string>().find("no rigid motion"), std::string::npos);
  ASSERT_EQ(movements[0]["landmarks"].size(), 1u);
  EXPECT_NEAR(movements[0]["landmarks"][0]["up_mm"].get<double>(), 3.0, 1e-12);
}

TEST(Affine, RigidOnlyConsumersRefuseInOneSentence) {
  const ScratchFolder folder;
  const std::string egg = R"({"id": "egg", "do": "affine", "object": "ball", "scale": [1.1, 1, 1],
      "about_mm": [0, 0, 0]})";
  EXPECT_NE(made_refusal(folder,
                         ball_caps(egg + R"(, {"id": "m", "do": "move", "object": "upper", "with": "egg"})"))
                .find("'egg' was scaled or sheared"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "m", "do": "move", "object": "ball",
      "matrix": [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]})")
                .find("use 'affine'"),
            std::string::npos);
  const Plan plan = ball_plan(folder, egg);
  const Evaluation evaluation = evaluate(plan);
  EXPECT_THROW(outcome_of(plan, evaluation, ball_scene(ball_radius_mm)), std::runtime_error);
  const std::string text = made_refusal(folder, ball_caps(R"(
      {"id": "screw", "do": "screw", "object": "upper", "at": [0, -20, 8], "direction": [0, 1, 0]},
      {"id": "other", "do": "screw", "object": "upper", "at": [8, -18, 8], "direction": [0, 1, 0]},
      {"id": "thick", "do": "affine", "object": "other", "scale": [2, 2, 1], "about_mm": [0, 0, 20]},
      {"id": "plate", "do": "plate", "object": "upper", "side": "anterior", "screws": ["screw", "thick"]})"));
  EXPECT_NE(text.find("'thick' is scaled or sheared, but a screw must keep its shape"), std::string::npos)
      << text;
}

TEST(Affine, WrongInputIsRefusedInOneLineEach) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& fields) {
    const std::string text =
        ball_refusal(folder, R"({"id": "egg", "do": "affine", "object": "ball", )" + fields + "}");
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  };
  const std::string about = R"(, "about_mm": [0, 0, 0])";
  const std::vector<std::pair<std::string, std::string>> cases{
      {R"("about_mm": [0, 0, 0])", "changes nothing"},
      {R"("scale": [1, 1, 2])", "'about_mm' is missing"},
      {R"("scale": [1, 1, 1])" + about, "rigid motion, which neither scales nor shears"},
      {R"("scale": [1, 0, 1])" + about, "become flat"},
      {R"("scale": [1, -1, 1])" + about, "mirrors the object: use 'mirror'"},
      {R"("scale": [1, 1, 1e300])" + about, "0.01 to 100 are allowed"},
      {R"("scale": [1, 1, "x"])" + about, "scale"},
      {R"("shear": {"by": 0.3, "along": [1, 0, 0], "normal": [1, 0, 1]})" + about, "at right angles"},
      {R"("shear": {"by": 0.3, "along": [0, 0, 0]})" + about, "direction"},
      {R"("shear": {"by": 1e9})" + about, "0.01 to 100 are allowed"},
      {R"("matrix": [[1, 1, 0, 0], [1, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])", "become flat"},
      {R"("matrix": [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0.1, 1]])", "not affine"},
      {R"("matrix": [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], "scale": [2, 1, 1])" + about,
       "twice"},
      {R"("matrix": [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])", "'move'"}};
  for (const auto& [fields, words] : cases)
    EXPECT_NE(refusal(fields).find(words), std::string::npos) << fields << "\n" << refusal(fields);
  EXPECT_NE(made_refusal(folder, R"({"id": "egg", "do": "affine", "object": "ball", "file": "none.tfm"})")
                .find("none.tfm"),
            std::string::npos);
}

TEST(Affine, ATransformFileThatScalesIsRead) {
  const ScratchFolder folder;
  // From after the motion to before: half as long along x.
  std::ofstream(folder / "wide.tfm") << "#Insight Transform File V1.0\n#Transform 0\n"
                                        "Transform: AffineTransform_double_3_3\n"
                                        "Parameters: 0.8 0 0 0 1 0 0 0 1 0 0 0\nFixedParameters: 0 0 0\n";
  const Evaluation evaluation =
      evaluate(ball_plan(folder, R"({"id": "egg", "do": "affine", "object": "ball", "file": "wide.tfm"})"));
  expect_certified(evaluation.object("egg"), 1.25 * ball_mm3(ball_radius_mm), 0.005);
  EXPECT_NE(ball_refusal(folder, R"({"id": "m", "do": "transform", "object": "ball", "file": "wide.tfm"})")
                .find("use 'affine'"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
