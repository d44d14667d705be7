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

TEST(PreparedScan, TakesOutASupportThatHangsOnTheHeadAndSaysWhereThereIsNone) {
  const ScratchFolder folder;
  // A ball of 20 mm, a board of 4 mm behind it, and a bridge of 2 mm between them.
  const auto in_head = [](const glm::dvec3& p) { return glm::length(p * glm::dvec3(1, 1, 0.5)) < 20; };
  const auto in_bridge = [](const glm::dvec3& p) { return std::abs(p.x) < 1 && p.y > 0 && p.y < 26; };
  const auto field = [&](bool has_support) {
    return tests::ct_scene({80, 90, 40}, {1, 1, 1}, {-39.5, -39.5, -19.5},
                           [&](const glm::ivec3& /*at*/, const glm::dvec3& p) {
                             const bool in_board = p.y > 26 && p.y < 30;
                             return in_head(p) || (has_support && (in_board || in_bridge(p))) ? 60 : -1000;
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
  // The board's four layers of 80 by 40 samples, and the bridge. Of the bridge a foot may stay on the head:
  // up to the contact of 3 mm and one cell of 2 mm.
  const double board = 80 * 4 * 40;
  double bridge = 0.0, foot = 0.0;
  const voxel::Lattice lattice = field(true).lattice;
  for (int z = 0; z < 40; ++z)
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 80; ++x) {
        const glm::dvec3 p = lattice.lps_mm({x, y, z});
        if (!in_bridge(p) || in_head(p)) continue;
        bridge += 1.0;
        foot += in_head(p - glm::dvec3(0, 5, 0));
      }
  ASSERT_GT(bridge - foot, 100.0);
  const Evaluation hanging = step(field(true), "");
  const double removed = hanging.scans[1].details["volume_removed_mm3"].get<double>();
  EXPECT_GE(removed, board + bridge - foot);
  EXPECT_LE(removed, board + bridge);
  EXPECT_EQ(hanging.scans[1].details["parts_removed"], 1);
  const Evaluation alone = step(field(false), "");
  EXPECT_NEAR(hanging.object("skin").voxel.measures.volume_mm3,
              alone.object("skin").voxel.measures.volume_mm3 + board + bridge - removed, 1.0)
      << "nothing of the head is gone";
  // Nothing hangs on a head alone: the finding says so, and recommends no value.
  EXPECT_EQ(alone.scans[1].details["samples_removed"], 0);
  EXPECT_NE(alone.scans[1].audit.back().detail.find("crop"), std::string::npos);
  EXPECT_EQ(alone.scans[1].audit.back().detail.find("remove_headrest="), std::string::npos);
}

TEST(PreparedScan, TakesOutABoardThatIsFlushWithTheHead) {
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
  EXPECT_NEAR(flush.object("skin").voxel.measures.volume_mm3, ball_mm3(18.0), 0.03 * ball_mm3(18.0));
  EXPECT_NEAR(flush.scans[1].details["volume_removed_mm3"].get<double>(), 70 * 8 * 40, 0.05 * 70 * 8 * 40);
  // The twin: a board thicker than twice the limit is none, and what touches the patient stays.
  EXPECT_LT(step(R"(, "board_mm": 3)").scans[1].details["volume_removed_mm3"].get<double>(), 70 * 8 * 40);
}

TEST(PreparedScan, ScaleSpacePartsBallsThatTouchIntoLabels) {
  const ScratchFolder folder;
  voxel::write_scene(
      tests::ct_scene(
          {64, 40, 40}, {1, 1, 1}, {-31.5, -19.5, -19.5},
          [](const glm::ivec3&, const glm::dvec3& p) {
            const bool is_in = glm::distance(p, {-10, 0, 0}) < 12.0 || glm::distance(p, {12, 0, 0}) < 11.0;
            return is_in ? 1000 : -1000;
          }),
      folder / "ct.nrrd");
  const Evaluation evaluation =
      evaluate(parse_plan(R"({"octotomy_plan": 1, "name": "n", "scans": {"ct": {"path": "ct.nrrd"}},
      "universe": {"voxel_mm": 1.0}, "steps": [
        {"id": "regions", "do": "scale_space", "scan": "ct", "sigma_mm": 5, "window": "0:"},
        {"id": "left", "do": "segment", "scan": "regions", "label": 1},
        {"id": "right", "do": "segment", "scan": "regions", "label": 2}]})",
                          folder.path()));
  EXPECT_EQ(evaluation.scans[1].details["regions"], 2);
  EXPECT_EQ(evaluation.scans[1].meaning, voxel::Meaning::Label);
  EXPECT_NEAR(evaluation.object("left").voxel.measures.volume_mm3, ball_mm3(12), 0.06 * ball_mm3(12));
  EXPECT_NEAR(evaluation.object("right").voxel.measures.volume_mm3, ball_mm3(11), 0.06 * ball_mm3(11));
}

TEST(PreparedScan, AGuessedThresholdOfTheFieldIsAWarningOfTheAudit) {
  const ScratchFolder folder;
  voxel::Scene scene = ball_scene(20.0, 48);
  scene.meaning = voxel::Meaning::Raw;
  scene.modality = "MR";
  for (std::int16_t& sample : std::get<voxel::Int16Samples>(scene.samples))
    sample = static_cast<std::int16_t>((sample + 1000) / 8 + 5);
  voxel::write_scene(scene, folder / "mr.nrrd");
  const auto step = [&](const std::string& more) {
    return evaluate(parse_plan(R"({"octotomy_plan": 1, "name": "n", "scans": {"mr": {"path": "mr.nrrd"}},
      "steps": [{"id": "even", "do": "n4_bias_field", "scan": "mr", "levels": 1, "iterations": 2)" +
                                   more +
                                   R"(},
                {"id": "ball", "do": "window", "scan": "even", "low": 100}]})",
                               folder.path()));
  };
  const Evaluation guessed = step("");
  ASSERT_FALSE(guessed.scans[1].audit.empty());
  EXPECT_EQ(guessed.scans[1].audit.back().verdict, voxel::Verdict::Warn);
  EXPECT_NE(guessed.scans[1].audit.back().detail.find("Otsu"), std::string::npos);
  EXPECT_NEAR(guessed.object("ball").voxel.measures.volume_mm3 / ball_mm3(20), 1.0, 0.05);
  for (const voxel::Finding& finding : step(R"(, "threshold": 60)").scans[1].audit)
    EXPECT_EQ(finding.detail.find("Otsu"), std::string::npos) << finding.detail;
}

TEST(PreparedScan, NamesAndValuesThatCannotBeAreRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "ct", "do": "gaussian", "scan": "ct", "sigma_mm": 1})")
                .find("is the name of a scan"),
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
