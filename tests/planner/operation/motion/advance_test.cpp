// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(AdvanceStep, GoesToContactAndStopsAGapBefore) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, ball_caps(R"(
      {"id": "met", "do": "advance", "object": "lower", "against": "upper", "towards": "up"},
      {"id": "near", "do": "advance", "object": "lower", "against": "upper", "direction": [0, 0, 7],
          "gap_mm": 2},
      {"id": "deep", "do": "move", "object": "lower", "translate_mm": [0, 0, 13]},
      {"id": "freed", "do": "advance", "object": "deep", "against": "upper", "towards": "up"})")));
  const auto told = [&](const char* id) {
    return evaluation.object(id).moved->details.at("contact_after_mm").get<double>();
  };
  EXPECT_NEAR(told("met"), 10.0, 1.0);
  EXPECT_NEAR(evaluation.object("met").moved->motion[3].z, told("met"), 1e-12);
  EXPECT_EQ(told("near"), told("met"));
  EXPECT_NEAR(evaluation.object("near").moved->motion[3].z, told("met") - 2.0, 1e-9);
  EXPECT_NEAR(told("freed"), -3.0, 1.0);
  // A flat face along the lattice counts up to half a layer of voxels more or less.
  expect_certified(evaluation.object("met"), cap_mm3(ball_radius_mm, 5.0), 0.08);
}

TEST(AdvanceStep, RefusalsPointAtThePlace) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& fields) {
    return ball_refusal(folder,
                        ball_caps(R"({"id": "a", "do": "advance", "object": "lower", )" + fields + "}"));
  };
  EXPECT_NE(refusal(R"("against": "lower", "towards": "up")").find("step 'a', against: is the object itself"),
            std::string::npos);
  EXPECT_NE(refusal(R"("against": "upper")").find("needs either 'towards'"), std::string::npos);
  EXPECT_NE(refusal(R"("against": "upper", "towards": "upp")").find("up"), std::string::npos);
  EXPECT_NE(refusal(R"("against": "upper", "direction": [0, 0, 0])").find("has no length"),
            std::string::npos);
  try {
    evaluate(
        ball_plan(folder, ball_caps(R"({"id": "a", "do": "advance", "object": "lower", "against": "upper",
        "towards": "down"})")));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("meets nothing of 'upper' within 30 mm"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace octotomy::planner
