// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/first_look.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

/// A bone ball of radius 8 within a soft one of radius 13, values as a scanner without rescale stores them.
voxel::Scene raw_head() {
  voxel::Scene scene = tests::ball_scene(13.0, 32);
  const voxel::Scene inner = tests::ball_scene(8.0, 32);
  auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  const auto& bone = std::get<voxel::Int16Samples>(inner.samples);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] = static_cast<std::int16_t>(20 + (samples[i] + 1000) / 2 + (bone[i] + 1000) / 2);
  scene.meaning = voxel::Meaning::Raw;
  scene.modality = "";
  return scene;
}

TEST(FirstLook, ThresholdsPartThreeClassesOfSamples) {
  const Thresholds thresholds = thresholds_of(raw_head());
  EXPECT_GT(thresholds.lower, 20.0);
  EXPECT_LE(thresholds.lower, 1020.0);
  EXPECT_GT(thresholds.upper, 1020.0);
  EXPECT_LE(thresholds.upper, 2020.0);
}

TEST(FirstLook, FewBrightSamplesOfMetalDoNotMoveThresholds) {
  voxel::Scene scene = raw_head();
  const Thresholds before = thresholds_of(scene);
  auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  for (std::size_t i = 0; i < 20; ++i) samples[i * 1500] = 30000;
  const Thresholds after = thresholds_of(scene);
  // One bin of 256 over the range of the other samples.
  EXPECT_NEAR(after.lower, before.lower, 2000.0 / 255.0 + 1.0);
  EXPECT_NEAR(after.upper, before.upper, 2000.0 / 255.0 + 1.0);
}

TEST(FirstLook, AScanOfOneValueIsRefused) {
  voxel::Scene scene = tests::ball_scene(13.0, 16);
  for (auto& sample : std::get<voxel::Int16Samples>(scene.samples)) sample = 7;
  EXPECT_THROW(thresholds_of(scene), std::runtime_error);
}

TEST(FirstLook, ARawScanIsLookedAtWithAWarning) {
  const tests::ScratchFolder folder;
  voxel::write_scene(raw_head(), folder / "head.nrrd");
  const Result result = first_look(folder / "head.nrrd");
  ASSERT_FALSE(result.findings.empty());
  EXPECT_EQ(result.findings[0].verdict, voxel::Verdict::Warn);
  EXPECT_NEAR(result.evaluation.object("bone").voxel.measures.volume_mm3, tests::ball_mm3(8.0),
              0.1 * tests::ball_mm3(8.0));
  EXPECT_NEAR(result.evaluation.object("skin").voxel.measures.volume_mm3, tests::ball_mm3(13.0),
              0.1 * tests::ball_mm3(13.0));
  ASSERT_EQ(result.parts.size(), 1u);
  EXPECT_EQ(result.parts[0].volumes_mm3.size(), 1u);
  ASSERT_EQ(result.pictures.size(), 2u);
  EXPECT_EQ(result.pictures[0].pictures.size(), all_views().size());
}

TEST(FirstLook, PicturesAndAuditAreSeenBeforeCertificates) {
  const tests::ScratchFolder folder;
  voxel::write_scene(raw_head(), folder / "head.nrrd");
  std::vector<Result> seen;
  std::vector<double> shares;
  LookOptions options{1500.0, 500.0, {}};
  options.evaluation.progress = [&](const std::string&, double share) { shares.push_back(share); };
  options.seen = [&](Result first) {
    EXPECT_LT(shares.back(), 0.5);
    seen.push_back(std::move(first));
  };
  const Result whole = first_look(folder / "head.nrrd", options);
  ASSERT_EQ(seen.size(), 1u);
  const Result& first = seen.front();
  ASSERT_EQ(first.findings.size(), 1u);
  EXPECT_EQ(first.findings[0].check, "certificates");
  EXPECT_TRUE(whole.findings.empty());
  ASSERT_EQ(first.evaluation.scans.size(), 1u);
  EXPECT_FALSE(first.evaluation.scans[0].audit.empty());
  EXPECT_EQ(first.evaluation.scans[0].sha256, whole.evaluation.scans.at(0).sha256);
  for (const char* id : {"bone", "skin"}) {
    const Object &before = first.evaluation.object(id), &after = whole.evaluation.object(id);
    EXPECT_FALSE(before.certificate);
    ASSERT_TRUE(after.certificate);
    EXPECT_EQ(after.certificate->verdict, verify::Verdict::Pass);
    EXPECT_TRUE(before.voxel.octree == after.voxel.octree);
  }
  ASSERT_EQ(first.pictures.size(), 2u);
  EXPECT_EQ(first.pictures[0].pictures[0].png, whole.pictures.at(0).pictures.at(0).png);
  EXPECT_EQ(first.parts[0].volumes_mm3, whole.parts.at(0).volumes_mm3);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1.0);
}

TEST(FirstLook, ItsPlanCanBeReplayed) {
  const tests::ScratchFolder folder;
  voxel::write_scene(raw_head(), folder / "head.nrrd");
  const Result result = first_look(folder / "head.nrrd", {1500.0, 500.0, {}});
  EXPECT_TRUE(result.findings.empty());
  const Evaluation again = evaluate(parse_plan(result.plan.text, "/"));
  EXPECT_TRUE(again.object("bone").voxel.octree == result.evaluation.object("bone").voxel.octree);
}

}  // namespace
}  // namespace octotomy::planner
