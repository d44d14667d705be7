// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Plates on a ball, whole and in two pieces of which one is moved.
#include <cmath>
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

std::string plate_step(const std::string& fields, const std::string& object = "ball") {
  return R"({"id": "plate", "do": "plate", "object": ")" + object + R"(", "side": "anterior", )" + fields +
         "}";
}
const std::string across = R"("points": [[-8, -18.33, 0], [0, -20, 0], [8, -18.33, 0]])";

TEST(PlateStep, OnABallHasItsCrossSectionAndFollowsTheBoneInBothKernels) {
  const ScratchFolder folder;
  // The ball's voxels have their centres at halves of a millimetre. About z = 0 both sides, 3.5 mm off, would
  // pass through centres and count for up to half a voxel each, 7 % of the plate.
  constexpr double middle_mm = 0.25;
  const Evaluation made = evaluate(
      ball_plan(folder, plate_step(R"("points": [[-8, -18.33, 0.25], [0, -20, 0.25], [8, -18.33, 0.25]])")),
      {});
  const Object& plate = made.objects.at("plate");
  ASSERT_TRUE(plate.mesh.within) << testing::PrintToString(plate.findings);
  EXPECT_EQ(plate.mesh.within->components().size(), 1u);
  const brep::SurfaceTree& tree = plate.mesh.within->tree();
  // 2.5 mm from 0.2 mm off the ball, 7 mm wide, and half discs beyond the points.
  EXPECT_TRUE(tree.is_inside({0, -20.35, 0}));
  EXPECT_FALSE(tree.is_inside({0, -20.05, 0}));
  EXPECT_TRUE(tree.is_inside({0, -22.6, 0}));
  EXPECT_NEAR(plate.mesh.within->size().low_mm.y, -22.7, 0.1);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(tree.is_inside({0, -21.0, middle_mm + sign * 3.4}));
    EXPECT_FALSE(tree.is_inside({0, -21.0, middle_mm + sign * 3.6}));
    EXPECT_FALSE(tree.is_inside({0, -22.35, middle_mm + sign * 3.4})) << "the outer edge is sharp";
    EXPECT_NEAR(sign > 0 ? plate.mesh.within->size().high_mm.x : -plate.mesh.within->size().low_mm.x, 11.5,
                0.1);
  }
  // A count of voxels scatters by 0.26 h^2 sqrt(S), three times which is 4 % here. Voxels this large keep the
  // inner edges, 16.5 mm on either side and two half circles, that the mesh rounds by half of the least wall.
  const double area_mm2 = plate.mesh.within->measures().area_mm2,
               volume_mm3 = plate.mesh.within->size().volume_mm3;
  const double edges_mm3 = (1.0 - 0.25 * M_PI) * 0.4 * 0.4 * (2.0 * 16.5 + 7.0 * M_PI);
  EXPECT_NEAR(plate.voxel.measures.volume_mm3, volume_mm3, 3.0 * 0.26 * std::sqrt(area_mm2) + edges_mm3);
  EXPECT_LT(3.0 * 0.26 * std::sqrt(area_mm2) + edges_mm3, 0.05 * volume_mm3);
  const Json& gap = plate.mesh.details.at("gap");
  EXPECT_NEAR(gap.at("mean_mm").get<double>(), 0.2, 0.06) << gap.dump(1);
  EXPECT_LE(std::abs(gap.at("mean_mm").get<double>() - 0.2), gap.at("mean_half_width_mm").get<double>());
  ASSERT_TRUE(plate.certificate);
  EXPECT_NE(verify::to_string(plate.certificate->verdict), "FAIL")
      << testing::PrintToString(plate.certificate->reasons);
  EXPECT_NE(testing::PrintToString(plate.findings).find("no holes"), std::string::npos);
}

/// Two caps 4 mm apart with a screw in each; the upper one and its screw are moved.
std::string two_pieces(const std::string& by_mm, const std::string& more) {
  const std::string move = R"("translate_mm": )" + by_mm + "}, ";
  return R"({"id": "high", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, 2], [30, 2], [30, 30], [-30, 30]]]}]},
      {"id": "low", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, -2], [30, -2], [30, -30], [-30, -30]]]}]},
      {"id": "upper", "do": "combine", "expression": "ball & high"},
      {"id": "lower", "do": "combine", "expression": "ball & low"},
      {"id": "up", "do": "screw", "object": "upper", "at": [0, -18.33, 8], "direction": [0, 1, 0],
        "cuts": ["high"]},
      {"id": "down", "do": "screw", "object": "lower", "at": [0, -18.33, -8], "direction": [0, 1, 0]},
      {"id": "moved", "do": "move", "object": "upper", )" +
         move + R"({"id": "up_moved", "do": "move", "object": "up", )" + move +
         R"({"id": "planned", "do": "combine", "expression": "lower | moved"}, )" + more;
}

TEST(PlateStep, BridgesTheGapAndHasItsHolesWhereTheMotionBringsTheScrews) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  const Plan plan = ball_plan(
      folder, two_pieces("[0, -1, 1.5]",
                         plate_step(R"("points": [[0, -19.33, 9.5], [0, -18.33, -8]],
                     "screws": ["up_moved", "down"], "away_from": ["lower"])",
                                    "planned") +
                             R"(, {"id": "seats", "do": "seating", "object": "plate", "against": ["planned"],
                     "direction": [0, 1, 0]})"));
  const Evaluation made = evaluate(plan, options);
  const Object& plate = made.objects.at("plate");
  ASSERT_TRUE(plate.mesh.within) << testing::PrintToString(plate.findings);
  const Json& details = plate.mesh.details;
  ASSERT_EQ(details.at("holes").size(), 2u);
  for (const Json& hole : details.at("holes"))
    EXPECT_LT(hole.at("off_axis_mm").get<double>(), 0.01) << details.dump(1);
  const Json& screws = details.at("screws");
  EXPECT_EQ(screws[0].at("placed_by"), "up");
  EXPECT_TRUE(screws[0].at("is_carried"));
  EXPECT_FALSE(screws[1].at("is_carried"));
  EXPECT_NEAR(screws[0].at("at_mm")[1].get<double>(), -19.33, 1e-9);
  EXPECT_NEAR(screws[0].at("at_mm")[2].get<double>(), 9.5, 1e-9);
  // The screw's own step measured 5 mm to the cut before the motion; the second distance is that to the lower
  // piece at the planned place.
  ASSERT_EQ(screws[0].at("clearances").size(), 2u) << screws.dump(1);
  EXPECT_FALSE(screws[0].at("clearances")[0].at("is_planned_place"));
  EXPECT_NEAR(screws[0].at("clearances")[0].at("distance_mm").get<double>(), 5.0, 0.05);
  EXPECT_NEAR(screws[0].at("clearances")[1].at("distance_mm").get<double>(), 10.5, 0.1);
  const brep::SurfaceTree& tree = plate.mesh.within->tree();
  EXPECT_FALSE(tree.is_inside({0.0, -21.0, 9.5})) << "no hole";
  EXPECT_FALSE(tree.is_inside({1.0, -20.0, -8.0})) << "no hole";
  EXPECT_TRUE(tree.is_inside({2.0, -20.7, 9.5}));
  EXPECT_TRUE(tree.is_inside({0.0, -22.0, 0.5})) << "no bridge";
  EXPECT_FALSE(tree.is_inside({0.0, -19.0, 0.5})) << "the plate falls into the gap";
  EXPECT_EQ(plate.mesh.within->components().size(), 1u);
  EXPECT_GT(details.at("gap").at("largest_mm").get<double>(), 1.5);
  const Json measured = measurements_json(plan, made);
  EXPECT_EQ(measured.at(0).at("verdict"), "PASS") << measured.dump(1);
}

TEST(PlateStep, WhereTheBoneFallsAwayTheFlangeIsCutOff) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  // The band's sides run beside the ball's flank, where what is between bone and outer face runs out.
  const Plan plan =
      ball_plan(folder, plate_step(R"("points": [[17.5, -9.68, 0], [12, -16, 0], [0, -20, 0]])") +
                            R"(, {"id": "prints", "do": "printable", "object": "plate"})");
  const Evaluation made = evaluate(plan, options);
  const Object& plate = made.objects.at("plate");
  ASSERT_TRUE(plate.mesh.within) << testing::PrintToString(plate.findings);
  EXPECT_GT(plate.mesh.details.at("thin_mm3").get<double>(), 0.0) << plate.mesh.details.dump(1);
  const Json measured = measurements_json(plan, made);
  for (const Json& line : measured.at(0).at("checks")) {
    EXPECT_NE(line.at("verdict"), "FAIL") << line.dump(1);
    if (line.at("check") == "wall") {
      EXPECT_GT(line.at("least_mm").get<double>(), 0.7);
    }
  }
}

TEST(PlateStep, RefusesWhatMakesNoPlateInASentenceThatSaysWhy) {
  const ScratchFolder folder;
  const auto expect_refused = [&](const std::string& steps, const std::string& words) {
    const std::string refusal = made_refusal(folder, steps);
    EXPECT_NE(refusal.find(words), std::string::npos) << words << "\n" << refusal;
  };
  expect_refused(plate_step(across + R"(, "thickness_mm": 0.1)"), "thickness_mm: must be from 0.8");
  expect_refused(plate_step(across + R"(, "bend_radius_mm": 4)"), "is less than twice 'thickness_mm'");
  expect_refused(plate_step(across + R"(, "least_wall_mm": 1.2)"), "is more than 'hole_wall_mm'");
  expect_refused(plate_step(across + R"(, "rounding_mm": 1.2)"), "is more than 0.45 of 'thickness_mm'");
  expect_refused(plate_step(R"("points": [[0, -20, 0]])"), "points");
  expect_refused(plate_step(R"("points": [[3, -30, 0], [0, -20, 0]])"), "10.1 mm off the surface of 'ball'");
  expect_refused(plate_step(R"("points": [[0, 20, 0], [0, -20, 0]])"), "lie behind each other");
  expect_refused(plate_step(R"("points": [[0, 18.33, 8], [0, -20, 0]])"),
                 "behind other bone along the direction in which the plate is put on");
  expect_refused(plate_step(across + R"(, "direction": [1, 0, 0])"),
                 "nobody on that side can put the plate on");
  expect_refused(plate_step(across + R"(, "screws": ["ball"])"), "'ball' is not a screw");
  const auto screw = [](const std::string& name, const std::string& at, const std::string& direction) {
    return R"({"id": ")" + name + R"(", "do": "screw", "object": "ball", "at": )" + at +
           R"(, "direction": )" + direction + "}, ";
  };
  expect_refused(screw("s", "[0, -18.33, 8]", "[0, 1, 0]") + plate_step(across + R"(, "screws": ["s"])"),
                 "the hole of 's' leaves no plate beside it");
  expect_refused(screw("s", "[0, -19.8, 2]", "[0, 1, 0]") + plate_step(across + R"(, "screws": ["s"])"),
                 "the hole of 's' leaves 0.4");
  expect_refused(screw("s", "[0, -20, 0]", "[0.9, 0.4, 0]") + plate_step(across + R"(, "screws": ["s"])"),
                 "points more than 45 degrees off");
  expect_refused(screw("s", "[0, -20, 0]", "[0, 1, 0]") + screw("t", "[2.5, -19.8, 0]", "[0, 1, 0]") +
                     plate_step(across + R"(, "screws": ["s", "t"])"),
                 "the holes of 's' and 't' are 0.300 mm apart");
  expect_refused(two_pieces("[0, -6, 0]", plate_step(R"("points": [[0, -24.33, 8], [0, -18.33, -8]],
                     "screws": ["up"])",
                                                     "planned")),
                 "name the object of the step that moved the screw");
}

}  // namespace
}  // namespace octotomy::planner
