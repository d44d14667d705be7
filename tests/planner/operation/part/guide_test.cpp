// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Guides on a ball, put on from the front, against integrals over the figure that a guide is.
#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

const std::string sawn =
    R"({"id": "sawn", "do": "saw", "object": "ball", "line_mm": [[-40, -40, 0], [40, -40, 0]],
    "direction": [0, 1, 0], "depth_mm": 90, "kerf_mm": 0.8}, )";
const std::string screw_above = R"({"id": "above", "do": "screw", "object": "ball", "at": [0, -18.33, 8],
    "direction": [0, 1, 0]}, )";

std::string guide_step(const std::string& fields) {
  return R"({"id": "jig", "do": "guide", "object": "ball", )" + fields + "}";
}
const std::string at_front = R"("side": "anterior", "points": [[0, -20, 0]])";

void expect_says(const std::string& refusal, const std::string& words) {
  EXPECT_NE(refusal.find(words), std::string::npos) << refusal;
}

/// The volume of a guide about one point: what lies within clearance and thickness of the part of the ball
/// within a distance of the axis, less the shadow of the ball grown by the clearance. By rings about the axis.
double guide_mm3(double radius_mm, double clearance_mm, double thickness_mm) {
  constexpr double step_mm = 0.01, ball_mm = ball_radius_mm;
  const double shell_mm = clearance_mm + thickness_mm, grown_mm = ball_mm + clearance_mm;
  const double rim_y_mm = -std::sqrt(ball_mm * ball_mm - radius_mm * radius_mm);
  double volume_mm3 = 0.0;
  for (double x = 0.5 * step_mm; x < radius_mm + shell_mm; x += step_mm)
    for (double y = -ball_mm - shell_mm + 0.5 * step_mm; y < 0.0; y += step_mm) {
      if (x < grown_mm && y > -std::sqrt(grown_mm * grown_mm - x * x)) continue;
      const double r = std::hypot(x, y);
      double off_mm = r - ball_mm;
      if (x * ball_mm / r > radius_mm)
        off_mm = y > rim_y_mm ? x - radius_mm : std::hypot(x - radius_mm, y - rim_y_mm);
      if (off_mm <= shell_mm) volume_mm3 += 2.0 * M_PI * x * step_mm * step_mm;
    }
  return volume_mm3;
}

TEST(GuideStep, OnABallIsTheShellOverTheRegionWithARoundRim) {
  const ScratchFolder folder;
  const Evaluation made = evaluate(ball_plan(folder, guide_step(at_front + R"(, "radius_mm": 8)")), {});
  const Object& jig = made.objects.at("jig");
  const double truth_mm3 = guide_mm3(8.0, 0.25, 3.0);
  ASSERT_TRUE(jig.mesh.within) << testing::PrintToString(jig.findings);
  EXPECT_NEAR(jig.mesh.within->size().volume_mm3 / truth_mm3, 1.0, 0.03);
  EXPECT_NEAR(jig.voxel.measures.volume_mm3 / truth_mm3, 1.0, 0.08);
  EXPECT_EQ(jig.mesh.within->components().size(), 1u);
  double nearest_mm = ball_radius_mm;
  for (const glm::dvec3& p_mm : jig.mesh.within->triangles().points_mm)
    nearest_mm = std::min(nearest_mm, glm::length(p_mm) - ball_radius_mm);
  EXPECT_NEAR(nearest_mm, 0.25, 0.08);
  EXPECT_NEAR(jig.mesh.within->size().low_mm.y, -23.25, 0.15);
  ASSERT_TRUE(jig.certificate);
  EXPECT_NE(verify::to_string(jig.certificate->verdict), "FAIL")
      << testing::PrintToString(jig.certificate->reasons);
}

TEST(GuideStep, ASlotIsAsWideAsKerfAndPlayAndItsWallsLeadTheSawOverItsDepth) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  const Plan plan = ball_plan(
      folder,
      sawn + screw_above +
          guide_step(at_front +
                     R"(, "radius_mm": 12, "cuts": ["sawn"], "screws": ["above"], "slot_depth_mm": 10)") +
          R"(, {"id": "seats", "do": "seating", "object": "jig", "against": ["ball"], "direction": [0, 1, 0]})");
  const Evaluation made = evaluate(plan, options);
  const Object& jig = made.objects.at("jig");
  ASSERT_TRUE(jig.mesh.within) << testing::PrintToString(jig.findings);
  const Json& details = jig.mesh.details;
  ASSERT_EQ(details.at("slots").size(), 1u) << details.dump(1);
  EXPECT_NEAR(details.at("slots")[0].at("width_mm").get<double>(), 1.0, 1e-9);
  // From one rim of the region to the other, less two ends of 4 mm.
  EXPECT_NEAR(details.at("slots")[0].at("length_mm").get<double>(), 24.0 - 8.0, 1.1);
  EXPECT_NEAR(jig.mesh.within->size().low_mm.y, -20.25 - 10.0, 0.2);
  const brep::SurfaceTree& tree = jig.mesh.within->tree();
  for (const double y_mm : {-21.5, -25.0, -29.0}) {
    EXPECT_FALSE(tree.is_inside({0.0, y_mm, 0.0})) << y_mm;
    EXPECT_FALSE(tree.is_inside({6.0, y_mm, 0.45})) << y_mm;
    EXPECT_TRUE(tree.is_inside({0.0, y_mm, 0.6})) << y_mm;
    EXPECT_TRUE(tree.is_inside({0.0, y_mm, -2.2})) << y_mm;
  }
  EXPECT_TRUE(tree.is_inside({10.0, -25.0, 0.0})) << "the slot's end is open";
  ASSERT_EQ(details.at("holes").size(), 1u);
  EXPECT_LT(details.at("holes")[0].at("off_axis_mm").get<double>(), 0.01);
  EXPECT_FALSE(tree.is_inside({0.5, -20.5, 8.5}));
  EXPECT_TRUE(tree.is_inside({0.0, -20.5, 9.3}));
  const Json measured = measurements_json(plan, made);
  EXPECT_EQ(measured.at(0).at("verdict"), "PASS") << measured.dump(1);
}

const Json& line_of(const Json& printable, const std::string& check) {
  for (const Json& line : printable.at("checks"))
    if (line.at("check") == check) return line;
  throw std::runtime_error("no line about " + check);
}

TEST(GuideStep, WallsOfASlotThatIsDeeperThanTheReachMeetTheBase) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  const Evaluation made = evaluate(
      ball_plan(folder, sawn + guide_step(at_front + R"(, "radius_mm": 12, "reach_mm": 8, "cuts": ["sawn"],
                                                      "slot_depth_mm": 20)")),
      options);
  const Object& jig = made.objects.at("jig");
  ASSERT_TRUE(jig.mesh.within) << testing::PrintToString(jig.findings);
  EXPECT_NEAR(jig.mesh.within->size().low_mm.y, -20.25 - 20.0, 0.2);
  for (const double y_mm : {-22.0, -25.0, -30.0, -38.0})
    for (const double x_mm : {0.0, 8.0}) {
      EXPECT_TRUE(jig.mesh.within->tree().is_inside({x_mm, y_mm, 1.5})) << x_mm << " " << y_mm;
      EXPECT_TRUE(jig.mesh.within->tree().is_inside({x_mm, y_mm, -1.5})) << x_mm << " " << y_mm;
    }
  EXPECT_EQ(jig.mesh.within->components().size(), 1u);
}

TEST(GuideStep, ASlotThatRunsOutAtTheGuidesEdgeLeavesNoSliver) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  // The slot's upper side lies 0.002 mm below the upper end of a drawn region, and its end is open.
  const std::string cut =
      R"({"id": "sawn", "do": "saw", "object": "ball", "line_mm": [[-40, -40, 5], [40, -40, 5]],
      "direction": [0, 1, 0], "depth_mm": 90, "kerf_mm": 0.8}, )";
  const Plan plan = ball_plan(folder, cut + guide_step(R"("side": "anterior", "region": {"view": "anterior",
          "polygons_mm": [[[-10, -6], [10, -6], [10, 5.502], [-10, 5.502]]]},
          "cuts": ["sawn"], "slot_form": "three_sided", "slot_depth_mm": 6)") +
                                          R"(, {"id": "prints", "do": "printable", "object": "jig"})");
  const Evaluation made = evaluate(plan, options);
  const Object& jig = made.objects.at("jig");
  ASSERT_TRUE(jig.mesh.within) << testing::PrintToString(jig.findings);
  EXPECT_GT(jig.mesh.details.at("thin_mm3").get<double>(), 0.0);
  EXPECT_NE(testing::PrintToString(jig.findings).find("walls thinner than 0.800 mm"), std::string::npos);
  const Json measured = measurements_json(plan, made);
  for (const char* check : {"closed", "self_crossing", "outward", "pieces", "cavities", "wall"})
    EXPECT_EQ(line_of(measured.at(0), check).at("verdict"), "PASS") << line_of(measured.at(0), check).dump(1);
  EXPECT_GT(line_of(measured.at(0), "wall").at("least_mm").get<double>(), 0.7);
}

/// A guide with two sleeves of 2.35 mm radius whose axes are a length apart.
Plan two_sleeves(const ScratchFolder& folder, double apart_mm) {
  std::string screws;
  for (const auto& [name, side] : {std::pair("left_one", 0.5), {"right_one", -0.5}})
    screws += R"({"id": ")" + std::string(name) + R"(", "do": "screw", "object": "ball", "at": [)" +
              std::to_string(side * apart_mm) + R"(, -19.87, 0], "direction": [0, 1, 0]}, )";
  return ball_plan(
      folder, screws + guide_step(at_front + R"(, "radius_mm": 9, "screws": ["left_one", "right_one"])") +
                  R"(, {"id": "prints", "do": "printable", "object": "jig"})");
}

TEST(GuideStep, SleevesThatMeetInAThinNeckArePartedByACleft) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  // The sleeves' circles have a common chord of 0.39 mm.
  const Plan plan = two_sleeves(folder, 4.684);
  const Evaluation made = evaluate(plan, options);
  const Object& jig = made.objects.at("jig");
  ASSERT_TRUE(jig.mesh.within) << testing::PrintToString(jig.findings);
  ASSERT_TRUE(jig.mesh.details.contains("necks_mm")) << testing::PrintToString(jig.findings);
  for (const Json& at_mm : jig.mesh.details.at("necks_mm"))
    EXPECT_NEAR(at_mm[0].get<double>(), 0.0, 0.5) << at_mm.dump();
  EXPECT_NE(testing::PrintToString(jig.findings).find("necks thinner than 0.600 mm"), std::string::npos);
  EXPECT_FALSE(jig.mesh.within->tree().is_inside({0.0, -25.0, 0.0}));
  const Json measured = measurements_json(plan, made);
  EXPECT_EQ(line_of(measured.at(0), "wall").at("verdict"), "PASS") << line_of(measured.at(0), "wall").dump(1);
  EXPECT_EQ(line_of(measured.at(0), "pieces").at("verdict"), "PASS");
}

TEST(GuideStep, SleevesThatMeetInAThickWallStayOnePiece) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  const Evaluation made = evaluate(two_sleeves(folder, 4.5), options);
  const Object& jig = made.objects.at("jig");
  ASSERT_TRUE(jig.mesh.within) << testing::PrintToString(jig.findings);
  EXPECT_FALSE(jig.mesh.details.contains("necks_mm"));
  EXPECT_TRUE(jig.mesh.within->tree().is_inside({0.0, -25.0, 0.0}));
  for (const Json& hole : jig.mesh.details.at("holes"))
    EXPECT_LT(hole.at("off_axis_mm").get<double>(), 0.005) << hole.dump();
}

TEST(GuideStep, AMaskGetsASlotWhereItsWallCutsBoneInTheRegionWhicheverViewDrewIt) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  for (const std::string view : {"anterior", "left"}) {
    const std::string mask = R"({"id": "below", "do": "mask", "regions": [{"view": ")" + view +
                             R"(", "polygons_mm": [[[-60, -40], [60, -40], [60, 1], [-60, 1]]]}]}, )";
    const Evaluation made = evaluate(
        ball_plan(folder,
                  mask + guide_step(at_front + R"(, "radius_mm": 12, "cuts": ["below"], "kerf_mm": 0.6)")),
        options);
    const Object& jig = made.objects.at("jig");
    ASSERT_TRUE(jig.mesh.within) << testing::PrintToString(jig.findings);
    ASSERT_EQ(jig.mesh.details.at("slots").size(), 1u) << view;
    EXPECT_NEAR(jig.mesh.details.at("slots")[0].at("width_mm").get<double>(), 0.8, 1e-9);
    const brep::SurfaceTree& tree = jig.mesh.within->tree();
    EXPECT_FALSE(tree.is_inside({0.0, -28.0, 1.0})) << view;
    EXPECT_TRUE(tree.is_inside({0.0, -28.0, 2.0})) << view;
    EXPECT_TRUE(tree.is_inside({0.0, -28.0, 0.0})) << view;
  }
}

TEST(GuideStep, RefusesWhatMakesNoGuideInASentenceThatSaysWhy) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& steps) { return made_refusal(folder, steps); };
  expect_says(refusal(guide_step(at_front + R"(, "thickness_mm": 0.1)")), "thickness_mm: must be from 1");
  expect_says(refusal(guide_step(at_front + R"(, "least_wall_mm": 1.9)")), "more than 0.9 of 'slot_wall_mm'");
  expect_says(refusal(guide_step(at_front + R"(, "direction": [1, 0, 0])")), "degrees off the view");
  expect_says(refusal(guide_step(R"("side": "anterior", "points": [[-19.3, -5, 0]], "radius_mm": 3,
                                    "direction": [0, 1, 0])")),
              "runs along the sides of 'ball'");
  expect_says(refusal(guide_step(R"("side": "anterior", "points": [[0, 20, 0]])")), "behind other bone");
  expect_says(refusal(guide_step(R"("side": "anterior", "points": [[0, -30, 0]])")),
              "10.0 mm off the surface");
  expect_says(refusal(guide_step(R"("side": "anterior", "region": {"view": "posterior",
                                    "polygons_mm": [[[-5, -5], [5, -5], [5, 5], [-5, 5]]]})")),
              "the region is drawn in the view 'posterior'");
  const std::string beside = R"({"id": "aside", "do": "saw", "object": "ball", "direction": [0, 1, 0],
      "line_mm": [[-40, -40, 17], [40, -40, 17]], "depth_mm": 90}, )";
  expect_says(refusal(beside + guide_step(at_front + R"(, "cuts": ["aside"])")),
              "the cut 'aside' misses the guide");
  const std::string across = R"({"id": "across", "do": "saw", "object": "ball", "direction": [0, 0, 1],
      "line_mm": [[-40, 0, -40], [40, 0, -40]], "depth_mm": 90}, )";
  expect_says(refusal(across + guide_step(at_front + R"(, "cuts": ["across"])")), "goes in at 90.0 degrees");
  const std::string in_slot = R"({"id": "near", "do": "screw", "object": "ball", "at": [0, -20, 1],
      "direction": [0, 1, 0]}, )";
  expect_says(refusal(sawn + in_slot + guide_step(at_front + R"(, "cuts": ["sawn"], "screws": ["near"])")),
              "the sleeve of 'near' runs through the slot of 'sawn'");
  expect_says(refusal(guide_step(at_front + R"(, "screws": ["ball"])")), "'ball' is not a screw");
  const std::string caps = R"({"id": "middle", "do": "mask", "regions": [{"view": "anterior",
      "polygons_mm": [[[-30, -2], [30, -2], [30, 2], [-30, 2]]]}]},
      {"id": "two", "do": "combine", "expression": "ball - middle"}, )";
  expect_says(refusal(caps + R"({"id": "jig", "do": "guide", "object": "two", "side": "anterior",
                                 "points": [[0, -19, 6], [0, -19, -6]]})"),
              "points 1 and 2 lie on two separate pieces");
  expect_says(refusal(caps + R"({"id": "jig", "do": "guide", "object": "two", "side": "anterior", "region":
      {"view": "anterior", "polygons_mm": [[[-8, -8], [8, -8], [8, 8], [-8, 8]]]}})"),
              "the region lies on two bones");
}

}  // namespace
}  // namespace octotomy::planner
