// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// A scan of two balls of 8 and 5 mm and a hollow one, and a plan on it.
Plan two_balls(const ScratchFolder& folder, const std::string& steps) {
  voxel::Scene scene = ball_scene(20.0);
  auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  std::size_t at = 0;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x, ++at) {
        const glm::dvec3 p = scene.lattice.lps_mm({x, y, z});
        // Partial volumes like those of ball_scene().
        const auto ball = [&](const glm::dvec3& centre, double radius) {
          return std::clamp(radius - glm::distance(p, centre), -0.5, 0.5) * 2000.0;
        };
        const double hollow = std::min(ball({12, 0, 0}, 10), -ball({12, 0, 0}, 5));
        samples[at] = static_cast<std::int16_t>(std::lround(std::max(ball({-14, 0, 0}, 8), hollow)));
      }
  voxel::write_scene(scene, folder / "two.nrrd");
  return parse_plan(R"({"octotomy_plan": 1, "name": "two", "scans": {"ct": {"path": "two.nrrd"}},
      "universe": {"voxel_mm": 1.0}, "steps": [)" +
                        steps + "]}",
                    folder.path());
}

TEST(SegmentStep, ThePartsOfAWindowAreChosenAlikeInBothKernels) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(two_balls(folder, R"(
      {"id": "all", "do": "segment", "scan": "ct", "window": "0:"},
      {"id": "large", "do": "segment", "scan": "ct", "window": "0:", "largest": true},
      {"id": "full", "do": "segment", "scan": "ct", "window": "0:", "largest": true, "fill": true},
      {"id": "enough", "do": "segment", "scan": "ct", "window": "0:", "at_least_mm3": 3000},
      {"id": "on", "do": "move", "object": "full", "translate_mm": [0.3, 0.2, -0.4]})"));
  const double hollow = ball_mm3(10) - ball_mm3(5);
  expect_certified(evaluation.object("all"), ball_mm3(8) + hollow, 0.03);
  expect_certified(evaluation.object("large"), hollow, 0.03);
  expect_certified(evaluation.object("full"), ball_mm3(10), 0.03);
  expect_certified(evaluation.object("enough"), hollow, 0.03);
  expect_certified(evaluation.object("on"), ball_mm3(10), 0.03);
}

/// Two balls, joined by a rod along x.
voxel::Scene joined_balls(const glm::dvec2& rod_yz, double rod_radius) {
  voxel::Scene scene = ball_scene(20.0);
  auto& samples = std::get<voxel::Int16Samples>(scene.samples);
  std::size_t at = 0;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x, ++at) {
        const glm::dvec3 p = scene.lattice.lps_mm({x, y, z});
        const auto ball = [&](const glm::dvec3& centre, double radius) {
          return std::clamp(radius - glm::distance(p, centre), -0.5, 0.5) * 2000.0;
        };
        const double off = glm::distance(glm::dvec2(p.y, p.z), rod_yz),
                     rod = std::abs(p.x) < 14.0 ? std::clamp(rod_radius - off, -0.5, 0.5) * 2000.0 : -1000.0;
        samples[at] = static_cast<std::int16_t>(
            std::lround(std::max({ball({-14, 0, 0}, 8), ball({13, 0, 0}, 10), rod})));
      }
  return scene;
}

/// A rod that is thinner than the voxels are apart joins the balls for the mesh and, as it lies, not for the
/// voxels.
TEST(SegmentStep, WhatOneKernelAloneJoinsByAThinNeckStaysInBoth) {
  const ScratchFolder folder;
  int kept = 0;
  for (const double z_mm : {0.0, 0.5, 1.0, 1.5}) {
    voxel::write_scene(joined_balls({0.3, z_mm}, 0.8), folder / "joined.nrrd");
    const Evaluation evaluation = evaluate(parse_plan(R"({"octotomy_plan": 1, "name": "joined",
        "scans": {"ct": {"path": "joined.nrrd"}}, "universe": {"voxel_mm": 2.0}, "steps": [
        {"id": "all", "do": "window", "scan": "ct", "low": 0},
        {"id": "segmented", "do": "segment", "scan": "ct", "window": "0:", "largest": true},
        {"id": "part", "do": "parts", "object": "all", "largest": 1}]})",
                                                      folder.path()));
    for (const char* name : {"segmented", "part"}) {
      const Object& object = evaluation.object(name);
      ASSERT_TRUE(object.certificate);
      EXPECT_TRUE(object.certificate->bridges.empty()) << name << " at " << z_mm;
      const double voxels_mm3 = object.voxel.measures.volume_mm3,
                   mesh_mm3 = object.mesh.whole->size().volume_mm3;
      EXPECT_NEAR(voxels_mm3, mesh_mm3, 0.08 * mesh_mm3) << name << " at " << z_mm;
      if (!object.mesh.details.contains("kept_bridges")) continue;
      ++kept;
      EXPECT_NEAR(mesh_mm3, ball_mm3(10) + ball_mm3(8), 0.08 * mesh_mm3);
      // The ball beyond the neck is no small part of the whole.
      EXPECT_EQ(object.certificate->verdict, verify::Verdict::Warn);
      EXPECT_EQ(object.mesh.details["kept_bridges"].size(), 1U);
    }
  }
  EXPECT_GT(kept, 0);
}

/// The neck is listed near the large ball, and the small one lies beyond the cube about that place.
TEST(SegmentStep, ANeckThatThePlanKeepsLeavesNoDoubt) {
  const ScratchFolder folder;
  voxel::write_scene(joined_balls({0.3, 0.5}, 0.8), folder / "joined.nrrd");
  const auto part_of = [&](const std::string& decided) {
    return evaluate(parse_plan(R"({"octotomy_plan": 1, "name": "joined",
        "scans": {"ct": {"path": "joined.nrrd"}}, "universe": {"voxel_mm": 2.0}, "steps": [
        {"id": "all", "do": "window", "scan": "ct", "low": 0},
        {"id": "part", "do": "parts", "object": "all", "largest": 1)" +
                                   decided + "}]}",
                               folder.path()))
        .object("part");
  };
  const Object open = part_of("");
  ASSERT_TRUE(open.mesh.details.contains("kept_bridges"));
  const std::string neck = open.mesh.details["kept_bridges"][0]["at_mm"].dump();
  const Object kept = part_of(R"(, "keep_bridges_mm": [)" + neck + "]");
  EXPECT_EQ(kept.certificate->verdict, verify::Verdict::Pass);
  EXPECT_FALSE(kept.mesh.details.contains("kept_bridges"));
  EXPECT_TRUE(kept.findings.empty());
  EXPECT_EQ(kept.voxel.measures.volume_mm3, open.voxel.measures.volume_mm3);
  // A decision about another place is none about this neck.
  const Object elsewhere = part_of(R"(, "keep_bridges_mm": [[-28, 14, 0]])");
  EXPECT_EQ(elsewhere.certificate->verdict, verify::Verdict::Warn);
}

/// The balls are joined by a rod of 2 mm: both kernels keep it or cut it as the step says.
TEST(SegmentStep, BridgesAreKeptAndCutAsThePlanSaysInBothKernels) {
  const ScratchFolder folder;
  voxel::write_scene(joined_balls({0, 0}, 1.0), folder / "joined.nrrd");
  const Evaluation evaluation = evaluate(parse_plan(R"({"octotomy_plan": 1, "name": "joined",
      "scans": {"ct": {"path": "joined.nrrd"}}, "universe": {"voxel_mm": 1.0}, "steps": [
      {"id": "joined", "do": "segment", "scan": "ct", "window": "0:", "largest": true},
      {"id": "cut", "do": "segment", "scan": "ct", "window": "0:", "largest": true,
       "cut_bridges_mm": [[-1.3, 0.2, 0.1]], "bridge_mm": 3.9},
      {"id": "kept", "do": "segment", "scan": "ct", "window": "0:", "largest": true,
       "cut_bridges_mm": [[0.2, 0.2, 0.1]], "bridge_mm": 4.4, "keep_bridges_mm": [[-2.6, 0, 0]]},
      {"id": "parts", "do": "parts", "object": "joined", "largest": 1,
       "cut_bridges_mm": [[-1.3, 0.2, 0.1]], "bridge_mm": 3.9},
      {"id": "on", "do": "move", "object": "cut", "translate_mm": [0.3, 0.2, -0.4]}]})",
                                                    folder.path()));
  const double large = ball_mm3(10), both = ball_mm3(10) + ball_mm3(8);
  expect_certified(evaluation.object("joined"), both, 0.04);
  expect_certified(evaluation.object("cut"), large, 0.04);
  expect_certified(evaluation.object("kept"), both, 0.04);
  expect_certified(evaluation.object("parts"), large, 0.04);
  expect_certified(evaluation.object("on"), large, 0.04);
}

TEST(SegmentStep, BridgesWithoutAChoiceOfPartsOrDecidedTwiceAreRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, R"({"id": "s", "do": "segment", "scan": "ct", "window": "0:",
                                     "cut_bridges_mm": [[0, 0, 0]]})")
                .find("'largest'"),
            std::string::npos);
  EXPECT_NE(ball_refusal(folder, R"({"id": "p", "do": "parts", "object": "ball", "largest": 1,
                                     "cut_bridges_mm": [[0, 0, 1]], "keep_bridges_mm": [[0, 0, 1]]})")
                .find("both have"),
            std::string::npos);
}

TEST(SegmentStep, WhatOnlyVoxelsKnowHasNoMeshAndSaysWhy) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(two_balls(folder, R"(
      {"id": "grown", "do": "segment", "scan": "ct", "tolerance": 400, "seeds_mm": [[-14, 0, 0]]},
      {"id": "seeded", "do": "segment", "scan": "ct", "window": "0:", "seeds_mm": [[-14, 0, 0]]},
      {"id": "opened", "do": "segment", "scan": "ct", "window": "0:", "open_mm": 2, "largest": true})"));
  for (const char* id : {"grown", "seeded", "opened"}) {
    const Object& object = evaluation.object(id);
    EXPECT_FALSE(object.mesh.whole) << id;
    ASSERT_EQ(object.findings.size(), 1u) << id;
    EXPECT_NE(object.findings[0].find("voxel"), std::string::npos) << object.findings[0];
  }
  EXPECT_NEAR(evaluation.object("seeded").voxel.measures.volume_mm3 / ball_mm3(8), 1.0, 0.03);
}

/// Number of voxels about which a witness is certain, and on how many of these the kernel differs.
struct Witnessed {
  std::size_t certain = 0, wrong = 0, inside = 0;
};
Witnessed witnessed(const Object& object) {
  Witnessed count;
  if (!object.witness) return count;
  const voxel::Universe& universe = object.voxel.octree.universe();
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const verify::AllowedSides sides =
            object.witness.allowed_sides(universe.lattice().lps_mm({x, y, z})).voxel;
        const bool is_inside = object.voxel.octree.contains({x, y, z});
        count.certain += !(sides.in && sides.out);
        count.wrong += !sides.allows(is_inside);
        count.inside += is_inside && !sides.out;
      }
  return count;
}

TEST(SegmentStep, ClassesAndRegionsByARunningMeanHaveAWitnessOfTheirOwn) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(two_balls(folder, R"(
      {"id": "class", "do": "segment", "scan": "ct", "clusters": 3, "class": 3},
      {"id": "largest", "do": "segment", "scan": "ct", "clusters": 2, "largest": true},
      {"id": "mean", "do": "segment", "scan": "ct", "tolerance": 900, "running_mean": true,
       "seeds_mm": [[-14, 0, 0]]})"));
  for (const char* id : {"class", "largest", "mean"}) {
    const Object& object = evaluation.object(id);
    const Witnessed count = witnessed(object);
    // For chosen parts, the witness is certain only outside of them.
    EXPECT_GT(count.certain, 200000u) << id;
    EXPECT_EQ(count.wrong, 0u) << id;
    EXPECT_FALSE(object.mesh.whole) << id;
    ASSERT_EQ(object.findings.size(), 1u) << id;
    EXPECT_NE(object.findings[0].find("voxel"), std::string::npos) << object.findings[0];
  }
  EXPECT_GT(witnessed(evaluation.object("class")).inside, 2000u);
  EXPECT_GT(witnessed(evaluation.object("mean")).inside, 1000u);
  EXPECT_EQ(evaluation.object("class").mesh.details["centres"].size(), 3u);
  EXPECT_NEAR(evaluation.object("mean").voxel.measures.volume_mm3 / ball_mm3(8), 1.0, 0.1);
}

TEST(SegmentStep, AWitnessSeesAVoxelThatIsWrong) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(two_balls(folder, R"(
      {"id": "class", "do": "segment", "scan": "ct", "clusters": 3, "class": 3},
      {"id": "other", "do": "segment", "scan": "ct", "clusters": 3, "class": 2},
      {"id": "mean", "do": "segment", "scan": "ct", "tolerance": 900, "running_mean": true,
       "seeds_mm": [[-14, 0, 0]]},
      {"id": "narrow", "do": "segment", "scan": "ct", "tolerance": 300, "running_mean": true,
       "seeds_mm": [[-14, 0, 0]]})"));
  for (const auto& [truth, spoiled] : {std::pair{"class", "other"}, std::pair{"mean", "narrow"}}) {
    Object wrong = evaluation.object(truth);
    wrong.voxel.octree = evaluation.object(spoiled).voxel.octree;
    EXPECT_GT(witnessed(wrong).wrong, 100u) << truth;
  }
}

TEST(SegmentStep, OtsuSettlesTheWindowThatBothKernelsTake) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(two_balls(folder, R"({"id": "bright", "do": "segment", "scan": "ct", "otsu": 2})"));
  const Object& bright = evaluation.object("bright");
  expect_certified(bright, ball_mm3(8) + ball_mm3(10) - ball_mm3(5), 0.05);
  ASSERT_EQ(bright.mesh.details["thresholds"].size(), 1u);
}

TEST(SegmentStep, AStructureWithoutAStructureSetIsRefused) {
  const ScratchFolder folder;
  for (const char* option : {R"("structure": "Mandible")", R"("other_identity": true)"})
    EXPECT_NE(
        ball_refusal(folder, std::string(R"({"id": "b", "do": "segment", "scan": "ct", "window": "0:", )") +
                                 option + "}")
            .find("add the set as 'regions'"),
        std::string::npos)
        << option;
}

TEST(SegmentStep, WhatCannotBeMeantIsRefused) {
  const ScratchFolder folder;
  const auto refusal = [&](const std::string& rest) {
    return ball_refusal(folder, R"({"id": "s", "do": "segment", "scan": "ct")" + rest + "}");
  };
  EXPECT_NE(refusal("").find("exactly one of"), std::string::npos);
  EXPECT_NE(refusal(R"(, "window": "0:", "label": 2)").find("exactly one of"), std::string::npos);
  EXPECT_NE(refusal(R"(, "tolerance": 3)").find("seeds_mm"), std::string::npos);
  EXPECT_NE(refusal(R"(, "otsu": 2, "class": 3)").find("one of the classes"), std::string::npos);
  EXPECT_NE(refusal(R"(, "clusters": 3, "class": 4)").find("one of the classes"), std::string::npos);
  EXPECT_NE(refusal(R"(, "clusters": 9)").find("8"), std::string::npos);
  EXPECT_NE(refusal(R"(, "clusters": 3, "otsu": 3)").find("exactly one of"), std::string::npos);
  EXPECT_NE(refusal(R"(, "window": "0:", "running_mean": true)").find("'tolerance'"), std::string::npos);
  EXPECT_NE(refusal(R"(, "window": "bonne")").find("did you mean 'bone'"), std::string::npos);
  EXPECT_NE(refusal(R"(, "window": "0:", "largest": true, "neighbours": 7)").find("18"), std::string::npos);
  EXPECT_NE(refusal(R"(, "window": "0:", "neighbours": 26)").find("'largest'"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
