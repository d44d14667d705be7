// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/parts.h"

#include <gtest/gtest.h>

#include "planner/operation/object/part_choice.h"
#include "tests/planner/ct_scene.h"
#include "tests/planner/operation/ball_operation.h"
#include "voxel/solid/combine.h"

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

/// The ball without the slab from -`below_mm` to `above_mm`: two caps, and the larger one by each kernel.
std::string caps_apart(const std::string& name, double below_mm, double above_mm) {
  const std::string low = std::to_string(-below_mm), high = std::to_string(above_mm);
  return R"({"id": "cut_)" + name +
         R"(", "do": "mask", "regions": [{"view": "anterior", "polygons_mm": [[[-30, )" + low + "], [30, " +
         low + "], [30, " + high + "], [-30, " + high + R"(]]]}]},
      {"id": "caps_)" +
         name + R"(", "do": "combine", "expression": "ball - cut_)" + name + R"("},
      {"id": "one_)" +
         name + R"(", "do": "parts", "object": "caps_)" + name + R"(", "largest": 1})";
}

TEST(PartsStep, OfPartsNearlyAsLargeAsEachOtherBothKernelsKeepTheSameAndTheChoiceIsADoubt) {
  const ScratchFolder folder;
  std::string steps;
  for (int i = 0; i < 8; ++i)
    steps += (i == 0 ? "" : ", ") + caps_apart(std::to_string(i), 4.0, 4.0 + 0.25 * (i - 4) + 0.1);
  const Evaluation evaluation = evaluate(ball_plan(folder, steps));
  int doubts = 0, passes = 0;
  for (int i = 0; i < 8; ++i) {
    const Object& one = evaluation.object("one_" + std::to_string(i));
    SCOPED_TRACE(one.id + testing::PrintToString(one.certificate->reasons));
    EXPECT_NE(one.certificate->verdict, voxel::Verdict::Fail);
    EXPECT_EQ(one.voxel.measures.centroid_mm->z > 0.0, one.mesh.within->measures().centroid_mm->z > 0.0);
    if (one.caveats.empty()) {
      passes += one.certificate->verdict == voxel::Verdict::Pass ? 1 : 0;
      continue;
    }
    ++doubts;
    EXPECT_EQ(one.certificate->verdict, voxel::Verdict::Warn);
    EXPECT_NE(one.caveats[0].reason.find("parts have nearly equal sizes"), std::string::npos);
    EXPECT_NE(one.caveats[0].reason.find("at_mm"), std::string::npos);
  }
  EXPECT_GT(doubts, 0);
  EXPECT_GT(passes, 0);
}

TEST(PartsStep, OfAPartNearlyAsLargeAsTheBoundBothKernelsHoldTheSame) {
  const ScratchFolder folder;
  const std::string caps = caps_apart("0", 4.0, 4.3);
  const Evaluation alone = evaluate(ball_plan(folder, caps));
  const Object& one = alone.object("one_0");
  const double voxels_mm3 = one.voxel.measures.volume_mm3, mesh_mm3 = one.mesh.within->size().volume_mm3;
  ASSERT_GT(std::abs(voxels_mm3 - mesh_mm3), 0.1);
  for (const auto& [least_mm3, is_between] :
       {std::pair(0.5 * (voxels_mm3 + mesh_mm3), true), std::pair(voxels_mm3 - 1500.0, false),
        std::pair(100.0, false)}) {
    const Evaluation evaluation = evaluate(
        ball_plan(folder, caps + R"(, {"id": "large", "do": "parts", "object": "caps_0", "at_least_mm3": )" +
                              std::to_string(least_mm3) + "}"));
    const Object& large = evaluation.object("large");
    SCOPED_TRACE(testing::PrintToString(large.certificate->reasons));
    EXPECT_NE(large.certificate->verdict, voxel::Verdict::Fail);
    EXPECT_EQ(large.mesh.within->components().size(), voxel::component_count(large.voxel.octree));
    EXPECT_EQ(large.caveats.empty(), !is_between);
    if (!is_between) continue;
    EXPECT_EQ(large.certificate->verdict, voxel::Verdict::Warn);
    EXPECT_NE(large.caveats[0].reason.find("on different sides of 'at_least_mm3'"), std::string::npos);
  }
}

TEST(PartsStep, APlateThatVoxelsBreakIntoSmallPartsIsADoubt) {
  const ScratchFolder folder;
  const auto depth_mm = [](const glm::dvec3& p) {
    const double plate =
        std::min({0.75 - std::abs(p.z - 20.0 - 0.12 * p.x), 28.0 - std::abs(p.x), 20.0 - std::abs(p.y)});
    return std::max(plate, 16.0 - glm::length(p));
  };
  voxel::write_scene(
      ct_scene({64, 48, 56}, glm::dvec3(1.0), {-32.0, -24.0, -20.0},
               [&](auto, const glm::dvec3& p) { return std::clamp(1000.0 * depth_mm(p), -1000.0, 1000.0); }),
      folder / "plate.nrrd");
  const Evaluation evaluation = evaluate(parse_plan(
      R"({"octotomy_plan": 1, "name": "plate", "scans": {"ct": {"path": "plate.nrrd"}},
      "universe": {"voxel_mm": 2.5}, "steps": [{"id": "all", "do": "window", "scan": "ct", "low": 0},
      {"id": "large", "do": "parts", "object": "all", "at_least_mm3": 2000}]})",
      folder.path()));
  const Object &all = evaluation.object("all"), &large = evaluation.object("large");
  ASSERT_EQ(all.mesh.within->components().size(), 2U);
  ASSERT_GT(all.mesh.within->components().back().volume_mm3, 2000.0);
  ASSERT_GT(voxel::component_count(all.voxel.octree), 2U);
  EXPECT_EQ(large.mesh.within->components().size(), 1U);
  EXPECT_EQ(large.certificate->verdict, voxel::Verdict::Warn)
      << testing::PrintToString(large.certificate->reasons);
  ASSERT_FALSE(large.caveats.empty());
  EXPECT_NE(large.caveats[0].reason.find("on different sides of 'at_least_mm3'"), std::string::npos);
}

TEST(PartsStep, APartOfWhichVoxelsLoseTheEndBeyondAThinNeckStays) {
  const ScratchFolder folder;
  // A ball of 3,591 mm3 and one of 697 mm3 on a rod too thin for the voxels; another ball of its own.
  const auto depth_mm = [](const glm::dvec3& p) {
    const double rod = 0.7 - glm::length(glm::dvec2(p.y - 0.1 * p.x, p.z - 0.16 * p.x));
    return std::max({9.5 - glm::length(p - glm::dvec3(-14, -1.4, -2.2)),
                     5.5 - glm::length(p - glm::dvec3(14, 1.4, 2.2)), std::min(rod, 14.0 - std::abs(p.x)),
                     10.0 - glm::length(p - glm::dvec3(0, 0, 30))});
  };
  voxel::write_scene(
      ct_scene({64, 32, 64}, glm::dvec3(1.0), {-32.0, -16.0, -20.0},
               [&](auto, const glm::dvec3& p) { return std::clamp(1000.0 * depth_mm(p), -1000.0, 1000.0); }),
      folder / "neck.nrrd");
  const Evaluation evaluation = evaluate(parse_plan(
      R"({"octotomy_plan": 1, "name": "neck", "scans": {"ct": {"path": "neck.nrrd"}},
      "universe": {"voxel_mm": 2.5}, "steps": [{"id": "all", "do": "window", "scan": "ct", "low": 0},
      {"id": "large", "do": "parts", "object": "all", "at_least_mm3": 1500}]})",
      folder.path()));
  const Object &all = evaluation.object("all"), &large = evaluation.object("large");
  ASSERT_EQ(all.mesh.within->components().size(), 2U);
  ASSERT_GT(voxel::component_count(all.voxel.octree), 2U);
  EXPECT_EQ(large.mesh.within->components().size(), 2U);
  EXPECT_EQ(large.certificate->verdict, voxel::Verdict::Warn)
      << testing::PrintToString(large.certificate->reasons);
}

TEST(LargestParts, OfEqualPartsAreAsManyAsWanted) {
  const voxel::Universe universe = voxel::universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);
  voxel::Expression all = voxel::Expression(voxel::Box{{-15, -15, -15}, {-5, -5, -5}});
  for (int i = 0; i < 5; ++i)
    all = all | voxel::Expression(voxel::Box{{-14.0 + 6 * i, 6, 6}, {-10.0 + 6 * i, 10, 10}});
  const voxel::Octree whole = voxel::combine(universe, all);
  for (std::size_t count = 1; count <= 7; ++count) {
    const voxel::Octree chosen = largest_parts(whole, count);
    EXPECT_EQ(voxel::component_count(chosen), std::min<std::size_t>(count, 6)) << count;
    EXPECT_EQ(chosen.voxel_count(), 1000 + 64 * (std::min<std::size_t>(count, 6) - 1)) << count;
  }
  EXPECT_TRUE(largest_parts(voxel::Octree::empty(universe), 2).is_empty());
}

TEST(PartsStep, AKernelThatKeepsTheSmallerPartOrSpoilsOneIsNotFollowed) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, caps_apart("far", 4.0, 10.0) + ", " + caps_apart("near", 4.0, 4.1) + R"(,
      {"id": "low_far", "do": "parts", "object": "caps_far", "at_mm": [[0, 0, -15]]},
      {"id": "high_far", "do": "parts", "object": "caps_far", "at_mm": [[0, 0, 15]]},
      {"id": "low_near", "do": "parts", "object": "caps_near", "at_mm": [[0, 0, -15]]},
      {"id": "high_near", "do": "parts", "object": "caps_near", "at_mm": [[0, 0, 15]]})"));
  const auto settled = [&](const std::string& of, voxel::Octree voxels, const std::string& mesh) {
    const Object& caps = evaluation.object("caps_" + of);
    Object made = evaluation.object(mesh + "_" + of);
    made.voxel.octree = std::move(voxels);
    settle_choice({[&] { return caps.voxel.octree; }, [&] { return *caps.mesh.whole; }, caps.witness},
                  evaluation.universe, {}, made);
    return made;
  };
  const auto is_high = [](const Object& made) { return made.mesh.whole->measures().centroid_mm->z > 0.0; };
  // The smaller part of caps that differ by far, by voxels and by the mesh.
  EXPECT_FALSE(is_high(settled("far", evaluation.object("high_far").voxel.octree, "low")));
  EXPECT_TRUE(is_high(settled("far", evaluation.object("low_far").voxel.octree, "high")));
  // If the caps are nearly equal, the other cap is followed in at least one direction.
  const auto followed = [&](const voxel::Octree& high, const voxel::Octree& low) {
    return int{is_high(settled("near", high, "low"))} + int{!is_high(settled("near", low, "high"))};
  };
  const voxel::Octree high = evaluation.object("high_near").voxel.octree,
                      low = evaluation.object("low_near").voxel.octree;
  // Nor is a kernel whose part the other one lacks.
  const Object& caps = evaluation.object("caps_near");
  Object made = evaluation.object("high_near");
  made.voxel.octree = low;
  settle_choice({[&] { return low; }, [&] { return *caps.mesh.whole; }, caps.witness}, evaluation.universe,
                {}, made);
  EXPECT_TRUE(is_high(made) && made.caveats.empty());
  // Without a bite of 6 mm neither is.
  const auto bitten = [&](const voxel::Octree& cap, double z_mm) {
    return voxel::combine(
        cap.universe(),
        voxel::Expression(cap) - voxel::Expression(voxel::Box{{-3, -3, z_mm - 3}, {3, 3, z_mm + 3}}));
  };
  EXPECT_EQ(followed(bitten(high, 10.0), bitten(low, -10.0)), 0);
  EXPECT_EQ(followed(high, low), 1);
}

}  // namespace
}  // namespace octotomy::planner
