// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// Two caps of the ball, cut off above 4 mm and below -10 mm.
const std::string two_caps = R"(
    {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
      "polygons_mm": [[[-30, -10], [30, -10], [30, 4], [-30, 4]]]}]},
    {"id": "caps", "do": "combine", "expression": "ball - cut"}, )";

TEST(PartsStep, TheLargerOfTwoCapsIsKeptByBothKernels) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, two_caps + R"(
      {"id": "one", "do": "parts", "object": "caps", "largest": 1},
      {"id": "both", "do": "parts", "object": "caps", "largest": 5},
      {"id": "large", "do": "parts", "object": "caps", "at_least_mm3": 8000},
      {"id": "out", "do": "move", "object": "one", "translate_mm": [0.3, 0, 0.4]})"));
  const double larger = cap_mm3(ball_radius_mm, 4.0), smaller = cap_mm3(ball_radius_mm, 10.0);
  ASSERT_GT(larger, 8000.0);
  ASSERT_LT(smaller, 8000.0);
  expect_certified(evaluation.object("one"), larger, 0.04);
  expect_certified(evaluation.object("both"), larger + smaller, 0.04);
  expect_certified(evaluation.object("out"), larger, 0.04);
  EXPECT_EQ(evaluation.object("one").mesh.details["of"], 2u);
}

TEST(PartsStep, ThePartThatHoldsAPointIsKeptByBothKernels) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, two_caps + R"(
      {"id": "low", "do": "parts", "object": "caps", "at_mm": [[0, 0, -15]]},
      {"id": "both", "do": "parts", "object": "caps", "at_mm": [[0, 0, -15], [3, 0, 12]]})"));
  const double larger = cap_mm3(ball_radius_mm, 4.0), smaller = cap_mm3(ball_radius_mm, 10.0);
  expect_certified(evaluation.object("low"), smaller, 0.04);
  expect_certified(evaluation.object("both"), larger + smaller, 0.04);
  try {
    evaluate(ball_plan(folder,
                       two_caps + R"({"id": "p", "do": "parts", "object": "caps", "at_mm": [[0, 0, 0]]})"));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("no part of 'caps' holds (0, 0, 0) mm"), std::string::npos);
  }
}

TEST(PartsStep, NeitherOrBothWaysToChooseAreRefused) {
  const ScratchFolder folder;
  for (const char* ways : {"", R"(, "largest": 1, "at_least_mm3": 3)"})
    EXPECT_NE(ball_refusal(folder, R"({"id": "p", "do": "parts", "object": "ball")" + std::string(ways) + "}")
                  .find("needs one of"),
              std::string::npos);
  EXPECT_THROW(evaluate(ball_plan(folder, R"({"id": "p", "do": "parts", "object": "ball",
                                               "at_least_mm3": 1e6})")),
               std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner
