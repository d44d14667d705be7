// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/planner/ct_scene.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

TEST(PreparedScan, AScanThatStepsMakeIsSegmentedInBothKernels) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, R"(
      {"id": "face", "do": "crop", "scan": "ct", "low_mm": [-25, -25, -25], "high_mm": [25, 25, 25]},
      {"id": "even", "do": "slices", "scan": "face", "spacing_mm": 0.7, "kernel": "cubic"},
      {"id": "calm", "do": "median", "scan": "even", "radius_samples": [1]},
      {"id": "again", "do": "window", "scan": "calm", "low": 0})"));
  expect_certified(evaluation.object("again"), ball_mm3(ball_radius_mm), 0.02);
  ASSERT_EQ(evaluation.scans.size(), 4u);
  EXPECT_EQ(evaluation.scans[1].lattice.dims, glm::ivec3(50));
  EXPECT_EQ(evaluation.scans[1].made_by, "crop of ct");
  EXPECT_EQ(evaluation.scans[2].details["kernel"], "cubic");
  EXPECT_NEAR(evaluation.scans[3].lattice.spacing_mm().z, 0.7, 1e-12);
  EXPECT_EQ(evaluation.universe.lattice().spacing_mm(), glm::dvec3(1.0)) << "the universe is the plan's";
  EXPECT_TRUE(evaluation.loaded.empty()) << "samples are let go after their last use";
}

TEST(PreparedScan, AHeadrestIsTakenOutAndThePlansScanStays) {
  const ScratchFolder folder;
  voxel::Scene scene = ball_scene(12.0);
  auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  for (std::size_t at = 0; at < samples.size(); ++at)
    if (at / 64 % 64 > 58 && at % 64 > 27 && at % 64 < 36) samples[at] = 500;  // a narrow table at the back
  voxel::write_scene(scene, folder / "ball.nrrd");
  const Evaluation evaluation =
      evaluate(parse_plan(R"({"octotomy_plan": 1, "name": "table", "scans": {"ct": {"path": "ball.nrrd"}},
      "steps": [{"id": "head", "do": "remove_headrest", "scan": "ct", "near_mm": 3},
                {"id": "ball", "do": "window", "scan": "head", "low": 0},
                {"id": "both", "do": "window", "scan": "ct", "low": 0}]})",
                          folder.path()));
  EXPECT_NEAR(evaluation.object("ball").voxel.measures.volume_mm3 / ball_mm3(12.0), 1.0, 0.02);
  EXPECT_GT(evaluation.object("both").voxel.measures.volume_mm3, 1.3 * ball_mm3(12.0));
  EXPECT_EQ(evaluation.scans[1].details["parts_removed"], 1);
}

TEST(PreparedScan, WarnsOfASupportThatHangsOnTheHeadAndTheAdviceTakesItOut) {
  const ScratchFolder folder;
  // A ball of 20 mm, a board of 4 mm behind it, and a bridge of 2 mm between them.
  const auto field = [](bool has_board, bool has_bridge) {
    return tests::ct_scene({80, 90, 40}, {1, 1, 1}, {-39.5, -39.5, -19.5},
                           [&](const glm::ivec3& /*at*/, const glm::dvec3& p) {
                             const bool in_head = glm::length(p * glm::dvec3(1, 1, 0.5)) < 20;
                             const bool in_board = has_board && p.y > 26 && p.y < 30;
                             const bool in_bridge = has_bridge && std::abs(p.x) < 1 && p.y > 0 && p.y < 30;
                             return in_head || in_board || in_bridge ? 60 : -1000;
                           });
  };
  const auto step = [&](const voxel::Scene& scene, const std::string& more) {
    voxel::write_scene(scene, folder / "ct.nrrd");
    return evaluate(parse_plan(R"({"octotomy_plan": 1, "name": "n", "scans": {"ct": {"path": "ct.nrrd"}},
      "steps": [{"id": "head", "do": "remove_headrest", "scan": "ct")" +
                                   more + R"(},
                {"id": "skin", "do": "window", "scan": "head", "low": 0}]})",
                               folder.path()));
  };
  const Evaluation hanging = step(field(true, true), "");
  EXPECT_EQ(hanging.scans[1].details["parts_removed"], 0);
  EXPECT_NEAR(hanging.scans[1].details["remains_mm3"].get<double>(), 80 * 4 * 40, 1500);
  ASSERT_FALSE(hanging.scans[1].audit.empty());
  const std::string advice = hanging.scans[1].audit.back().detail;
  ASSERT_NE(advice.find("remove_headrest=-300,25,3 takes it out"), std::string::npos) << advice;
  const Evaluation followed = step(field(true, true), R"(, "detach_mm": 3)");
  EXPECT_NEAR(followed.object("skin").voxel.measures.volume_mm3,
              step(field(false, false), "").object("skin").voxel.measures.volume_mm3, 500)
      << "the rim of what is cut off takes a little of the skin around the link";
  EXPECT_TRUE(followed.scans[1].details["remains_mm3"].is_null());
  // Nothing hangs on a head alone: the finding says so, and recommends nothing that does nothing.
  const Evaluation alone = step(field(false, false), "");
  EXPECT_TRUE(alone.scans[1].details["remains_mm3"].is_null());
  EXPECT_NE(alone.scans[1].audit.back().detail.find("crop"), std::string::npos);
}

TEST(PreparedScan, NamesABoardThatIsFlushWithTheHeadAndTheAdviceTakesItOut) {
  const ScratchFolder folder;
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice({80, 80, 40}, {1, 1, 1}, {-39.5, -39.5, -19.5});
  scene.meaning = voxel::Meaning::Hounsfield;
  scene.modality = "CT";
  voxel::Int16Samples samples;
  for (int z = 0; z < 40; ++z)
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 80; ++x) {
        const glm::dvec3 p = scene.lattice.lps_mm({x, y, z});
        samples.push_back(glm::length(p) < 18 || (p.y > 17 && p.y < 25 && std::abs(p.x) < 35) ? 60 : -1000);
      }
  scene.samples = std::move(samples);
  voxel::write_scene(scene, folder / "ct.nrrd");
  const auto step = [&](const std::string& more) {
    return evaluate(parse_plan(R"({"octotomy_plan": 1, "name": "n", "scans": {"ct": {"path": "ct.nrrd"}},
      "steps": [{"id": "head", "do": "remove_headrest", "scan": "ct")" +
                                   more + R"(},
                {"id": "skin", "do": "window", "scan": "head", "low": 0}]})",
                               folder.path()));
  };
  const Evaluation flush = step("");
  EXPECT_NEAR(flush.scans[1].details["board_remains_mm3"].get<double>(), 70 * 8 * 40, 1);
  EXPECT_TRUE(std::any_of(flush.scans[1].audit.begin(), flush.scans[1].audit.end(), [](const auto& finding) {
    return finding.detail.find("remove_headrest=-300,25,0,30 takes it out") != std::string::npos;
  }));
  const Evaluation followed = step(R"(, "board_mm": 30)");
  EXPECT_NEAR(followed.object("skin").voxel.measures.volume_mm3, ball_mm3(18.0), 0.03 * ball_mm3(18.0));
  EXPECT_TRUE(followed.scans[1].details["board_remains_mm3"].is_null());
}

TEST(PreparedScan, NamesAndValuesThatCannotBeAreRefused) {
  const ScratchFolder folder;
  EXPECT_NE(
      ball_refusal(folder, R"({"id": "ct", "do": "gaussian", "scan": "ct", "sigma_mm": 1})").find("taken"),
      std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "gaussian", "scan": "ball", "sigma_mm": 1})")
                .find("no scan is called 'ball'"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "median", "scan": "ct", "radius_samples": [1, 2]})")
                .find("each axis"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "median", "scan": "ct", "radius_samples": [1]},
                {"id": "m", "do": "measure", "object": "s"})")
                .find("'s' is a median step, not an object"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
