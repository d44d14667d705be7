// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>
#include <set>

#include "planner/operation/table/operation.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// One step of every operation that moves an object, and some of operations that do not.
constexpr const char* motion_steps = R"(
    {"id": "apart", "do": "move", "object": "lower", "translate_mm": [0, 0, -2]},
    {"id": "met", "do": "advance", "object": "apart", "against": "upper", "towards": "up", "gap_mm": 1},
    {"id": "seated", "do": "occlude", "object": "apart", "against": "upper", "about_mm": 3,
     "places": [[0, 0, -7]]},
    {"id": "closed", "do": "autorotate", "object": "apart", "against": "upper",
     "condyles": [[-20, 40, 0], [20, 40, 0]]},
    {"id": "laid", "do": "register", "object": "apart", "onto": "lower", "overlap": 1},
    {"id": "carried", "do": "transform", "object": "lower", "file": "down.tfm"},
    {"id": "cuts", "do": "flap_space", "uncut_at": 1, "number": 2, "curve": [[-30, 10, 0], [0, -6, 0], [30, 10, 0]],
     "donor": [[30, 12, 105], [33, 16, -105]], "start_mm": 40, "reach_mm": 10, "face": [45, 12, 105]},
    {"id": "placed", "do": "flap_move", "object": "lower", "segment": "cuts"},
    {"id": "taller", "do": "affine", "object": "lower", "scale": [1, 1, 1.1], "about_mm": [0, 0, -10]},
    {"id": "image", "do": "mirror", "object": "lower", "point_mm": [0, 0, 0], "normal": [1, 0, 0]},
    {"id": "larger", "do": "offset", "object": "lower", "by_mm": 1},
    {"id": "both", "do": "combine", "expression": "upper | met"})";

/// The plan of these steps, beside the transform file that one of them names: 2 mm down, from after to before.
Plan moving_plan(const ScratchFolder& folder) {
  std::ofstream(folder / "down.tfm") << "#Insight Transform File V1.0\n#Transform 0\n"
                                        "Transform: AffineTransform_double_3_3\n"
                                        "Parameters: 1 0 0 0 1 0 0 0 1 0 0 2\nFixedParameters: 0 0 0\n";
  return ball_plan(folder, ball_caps(motion_steps));
}

TEST(Motion, TheTableSaysOfEachOperationWhetherItsObjectCarriesAMotion) {
  const ScratchFolder folder;
  const Plan plan = moving_plan(folder);
  const Evaluation evaluation = evaluate(plan);
  std::set<std::string> seen;
  for (const Step& step : plan.steps) {
    const Operation& operation = step.action.operation();
    if (operation.makes != Makes::Object) continue;
    EXPECT_EQ(evaluation.object(step.id).moved.has_value(), operation.is_motion) << operation.name;
    seen.insert(operation.name);
  }
  for (const Operation& operation : operations())
    if (operation.is_motion) {
      EXPECT_TRUE(seen.contains(operation.name)) << operation.name << " has no step here";
    }
}

TEST(Motion, ADeckAndAnotherPieceFollowEveryKindOfMotion) {
  const ScratchFolder folder;
  moving_plan(folder);
  for (const char* id : {"apart", "met", "seated", "closed", "laid", "carried", "placed"}) {
    const std::string more = std::string(motion_steps) +
                             R"(, {"id": "follows", "do": "move", "object": "upper", "with": ")" + id +
                             R"("}, {"id": "deck", "do": "export", "object": "ball", "path": "ball.inp",
         "moved": [")" + id + R"("], "fixed": ["upper"]})";
    EXPECT_EQ(ball_refusal(folder, ball_caps(more)), "") << id;
  }
  const std::string still = std::string(motion_steps) + R"(, {"id": "deck", "do": "export", "object": "ball",
      "path": "ball.inp", "moved": ["larger"], "fixed": ["upper"]})";
  EXPECT_NE(ball_refusal(folder, ball_caps(still)).find("'larger' was made by 'offset'"), std::string::npos);
  // A deck follows a motion that is not rigid, too; another piece does not.
  const std::string taller = std::string(motion_steps) + R"(, {"id": "deck", "do": "export", "object": "ball",
      "path": "ball.inp", "moved": ["taller"], "fixed": ["upper"]})";
  EXPECT_EQ(ball_refusal(folder, ball_caps(taller)), "");
}

TEST(Motion, TheSchemaSaysWhatAnOperationMakesAndMoves) {
  const nlohmann::ordered_json schema = plan_schema();
  std::set<std::string> moving;
  for (const auto& step : schema.at("properties").at("steps").at("items").at("anyOf")) {
    ASSERT_TRUE(step.contains("x-makes")) << step.at("title");
    if (step.contains("x-moves")) {
      const auto& field = step.at("properties").at(step["x-moves"].get<std::string>());
      EXPECT_EQ(field.at("x-names"), "object") << step.at("title");
      moving.insert(step.at("title").get<std::string>());
    }
  }
  for (const Operation& operation : operations())
    EXPECT_EQ(moving.contains(operation.name), operation.is_motion) << operation.name;
}

}  // namespace
}  // namespace octotomy::planner
