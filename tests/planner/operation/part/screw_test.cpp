// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Screws in a ball, at known distances from a cut and from another object.
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

std::string screw_step(const std::string& fields) {
  return R"({"id": "screw", "do": "screw", "object": "ball", "direction": [0, 1, 0], )" + fields + "}";
}

TEST(ScrewStep, StatesHowFarItStaysFromACutAndFromAnotherObjectByBothKernels) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  // The cut ends at z = 0.5, the root begins at z = 12; the screw is 2 mm wide about z = 8.
  const std::string steps =
      R"({"id": "sawn", "do": "saw", "object": "ball", "line_mm": [[-40, -40, 0], [40, -40, 0]],
      "direction": [0, 1, 0], "depth_mm": 90, "kerf_mm": 1},
      {"id": "high", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, 12], [30, 12], [30, 30], [-30, 30]]]}]},
      {"id": "root", "do": "combine", "expression": "ball & high"}, )" +
      screw_step(R"("at": [0, -18.33, 8], "length_mm": 6, "away_from": ["root"],
                                          "cuts": ["sawn", "high"], "least_mm": 4)");
  const Evaluation made = evaluate(ball_plan(folder, steps), options);
  const Object& screw = made.objects.at("screw");
  EXPECT_NEAR(screw.mesh.whole->size().volume_mm3, M_PI * 6.0, 1e-6);
  const Json& clear = screw.mesh.details.at("clearances");
  ASSERT_EQ(clear.size(), 3u);
  EXPECT_NEAR(clear[0].at("distance_mm").get<double>(), 3.0, 0.02);
  EXPECT_NEAR(clear[1].at("distance_mm").get<double>(), 6.5, 0.02);
  EXPECT_NEAR(clear[2].at("distance_mm").get<double>(), 3.0, 0.02);
  for (const Json& line : clear)
    EXPECT_NEAR(line.at("voxel_distance_mm").get<double>(), line.at("distance_mm").get<double>(), 1.8)
        << line.dump();
  const std::string findings = testing::PrintToString(screw.findings);
  EXPECT_NE(findings.find("within 3.00 mm of 'root', less than the 4.00 mm"), std::string::npos) << findings;
  EXPECT_NE(findings.find("of the cut 'high'"), std::string::npos) << findings;
  EXPECT_EQ(findings.find("'sawn'"), std::string::npos) << findings;
}

TEST(ScrewStep, FromASideItGoesInWhereThePlaceIsSeenOnTheBone) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  const auto head = [&](const std::string& fields) {
    return evaluate(ball_plan(folder, R"({"id": "screw", "do": "screw", "object": "ball", )" + fields + "}"),
                    options)
        .objects.at("screw")
        .mesh.details.at("head_mm");
  };
  // In the ball's middle, before it and behind it: the front of a ball of 20 mm, 12 mm above its middle.
  for (const char* at : {"[0, 0, 12]", "[0, -70, 12]", "[0, 70, 12]"}) {
    const Json p = head(R"("side": "anterior", "at": )" + std::string(at));
    EXPECT_NEAR(p[0].get<double>(), 0.0, 1e-9);
    EXPECT_NEAR(p[1].get<double>(), -16.0, 0.1);
    EXPECT_NEAR(p[2].get<double>(), 12.0, 1e-9);
  }
  EXPECT_NEAR(head(R"("side": "left", "at": [0, 0, 12])")[0].get<double>(), 16.0, 0.1);
  EXPECT_NE(made_refusal(folder, R"({"id": "screw", "do": "screw", "object": "ball", "side": "anterior",
      "at": [0, 0, 25]})")
                .find("move 'at'"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, screw_step(R"("at": [0, 0, 12], "side": "anterior")"))
                .find("'side' or 'direction'"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "screw", "do": "screw", "object": "ball", "at": [0, 0, 12]})")
                .find("is missing: add it, or 'side'"),
            std::string::npos);
}

TEST(ScrewStep, AScrewThatGoesIntoARootIsNamed) {
  const ScratchFolder folder;
  EvaluateOptions options;
  options.certify = false;
  const std::string steps = R"({"id": "high", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, 12], [30, 12], [30, 30], [-30, 30]]]}]},
      {"id": "root", "do": "combine", "expression": "ball & high"}, )" +
                            screw_step(R"("at": [0, -15.4, 12.7], "away_from": ["root"])");
  const Evaluation made = evaluate(ball_plan(folder, steps), options);
  const std::string findings = testing::PrintToString(made.objects.at("screw").findings);
  EXPECT_NE(findings.find("the screw goes into 'root'"), std::string::npos) << findings;
}

TEST(ScrewStep, RefusesAPointOffTheBoneAndADirectionOutOfIt) {
  const ScratchFolder folder;
  EXPECT_NE(
      made_refusal(folder, screw_step(R"("at": [0, -30, 0])")).find("10.0 mm off the surface of 'ball'"),
      std::string::npos);
  EXPECT_NE(made_refusal(folder, R"({"id": "screw", "do": "screw", "object": "ball", "at": [0, -20, 0],
                                      "direction": [0, -1, 0]})")
                .find("does not enter 'ball'"),
            std::string::npos);
  EXPECT_NE(made_refusal(folder, screw_step(R"("at": [0, -20, 0], "cuts": ["ball"])"))
                .find("'ball' was made by 'window'"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
