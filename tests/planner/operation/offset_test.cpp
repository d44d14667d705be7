// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(OffsetStep, ABallGrowsAndShrinksByTheDistance) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "larger", "do": "offset", "object": "ball", "by_mm": 4},
      {"id": "smaller", "do": "offset", "object": "ball", "by_mm": -4})"));
  expect_of_mesh(evaluation.object("larger"), ball_mm3(ball_radius_mm + 4.0), 0.02);
  expect_of_mesh(evaluation.object("smaller"), ball_mm3(ball_radius_mm - 4.0), 0.03);
}

TEST(OffsetStep, ByNothingIsRefused) {
  const ScratchFolder folder;
  for (const char* nothing : {"0", "-0.0"})
    EXPECT_NE(ball_refusal(folder, R"({"id": "same", "do": "offset", "object": "ball", "by_mm": )" +
                                       std::string(nothing) + "}")
                  .find("step 'same', by_mm: 0 moves nothing"),
              std::string::npos)
        << nothing;
  EXPECT_EQ(ball_refusal(folder, R"({"id": "more", "do": "offset", "object": "ball", "by_mm": 0.1})"), "");
}

}  // namespace
}  // namespace octotomy::planner
