// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/object/part_choice.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/planner/ct_scene.h"
#include "tests/planner/operation/ball_operation.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

using namespace tests;

struct Ball {
  glm::dvec3 centre_mm;
  double radius_mm;
};

/// A plan in voxels of 2 mm on a scan of balls in samples of 1 mm, the first two joined by a rod of a radius.
Plan balls_plan(const ScratchFolder& folder, const std::vector<Ball>& balls, double rod_radius_mm,
                const std::string& steps) {
  const auto depth_mm = [&](const glm::dvec3& p) {
    const glm::dvec3 a = balls[0].centre_mm, b = balls[1].centre_mm, along = glm::normalize(b - a);
    const double at = glm::dot(p - a, along);
    double depth = -1.0;
    if (rod_radius_mm > 0.0 && at > 0.0 && at < glm::distance(a, b))
      depth = rod_radius_mm - glm::distance(p, a + at * along);
    for (const Ball& ball : balls) depth = std::max(depth, ball.radius_mm - glm::distance(p, ball.centre_mm));
    return depth;
  };
  voxel::write_scene(
      ct_scene({72, 40, 64}, glm::dvec3(1.0), {-36.0, -20.0, -20.0},
               [&](auto, const glm::dvec3& p) { return std::clamp(1000.0 * depth_mm(p), -1000.0, 1000.0); }),
      folder / "balls.nrrd");
  return parse_plan(R"({"octotomy_plan": 1, "name": "balls", "scans": {"ct": {"path": "balls.nrrd"}},
      "universe": {"voxel_mm": 2.0}, "steps": [)" +
                        steps + "]}",
                    folder.path());
}

const std::string two_largest = R"(
    {"id": "all", "do": "window", "scan": "ct", "low": 0},
    {"id": "segmented", "do": "segment", "scan": "ct", "window": "0:", "components": 2},
    {"id": "part", "do": "parts", "object": "all", "largest": 2})";

/// Expects that the mesh has its parts at the places of the voxels' parts.
void expect_same_parts(const Object& object) {
  ASSERT_TRUE(object.certificate);
  SCOPED_TRACE(object.id + testing::PrintToString(object.certificate->reasons));
  EXPECT_NE(object.certificate->verdict, voxel::Verdict::Fail);
  const double mesh_mm3 = object.mesh.within->measures().volume_mm3;
  EXPECT_NEAR(object.voxel.measures.volume_mm3, mesh_mm3, 0.08 * mesh_mm3);
  EXPECT_LT(glm::distance(*object.voxel.measures.centroid_mm, *object.mesh.within->measures().centroid_mm),
            0.5);
}

TEST(PartChoice, OfTwoPartsNearlyAsLargeAtTheCutOfTheRankingBothKernelsKeepTheSame) {
  const ScratchFolder folder;
  int doubts = 0;
  for (int i = 0; i < 16; ++i) {
    const glm::dvec3 by(0.13 * i, 0.09 * i, 0.17 * i);
    const Evaluation evaluation = evaluate(balls_plan(
        folder,
        {{{-18, 0, 0}, 11}, {glm::dvec3(14, 0, 0) + by, 6.0}, {{0, 0, 30}, i % 2 == 0 ? 6.005 : 5.995}}, 0.0,
        two_largest));
    for (const char* name : {"segmented", "part"}) {
      const Object& object = evaluation.object(name);
      expect_same_parts(object);
      EXPECT_EQ(object.mesh.whole->components().size(), 2U);
      if (object.caveats.empty()) continue;
      ++doubts;
      EXPECT_EQ(object.certificate->verdict, voxel::Verdict::Warn);
      EXPECT_NE(object.caveats[0].reason.find("'at_mm'"), std::string::npos) << object.caveats[0].reason;
      ASSERT_FALSE(object.certificate->shared_values.empty());
      EXPECT_NE(object.certificate->shared_values[0].find("by the voxels"), std::string::npos);
    }
  }
  EXPECT_GT(doubts, 0);
}

/// A rod that the voxels miss makes one part of the first two balls for the mesh, whose second part is the
/// third ball; for the voxels it is the second ball.
TEST(PartChoice, ANeckOfOneKernelAloneDoesNotChangeTheParts) {
  const ScratchFolder folder;
  int doubts = 0;
  for (const double y_mm : {0.0, 0.5, 1.0, 1.5}) {
    const Evaluation evaluation = evaluate(balls_plan(
        folder, {{{-18, y_mm, 0.7}, 11}, {{14, y_mm, 0.7}, 8}, {{0, 0, 30}, 6}}, 0.8, two_largest));
    for (const char* name : {"segmented", "part"}) {
      const Object& object = evaluation.object(name);
      expect_same_parts(object);
      if (object.caveats.empty()) continue;
      ++doubts;
      EXPECT_NE(object.caveats[0].reason.find("among the 2 largest"), std::string::npos);
      EXPECT_EQ(object.certificate->verdict, voxel::Verdict::Warn);
    }
  }
  EXPECT_GT(doubts, 0);
}

TEST(PartChoice, AKernelThatDoesNotKeepTheLargestPartsIsNotFollowed) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(balls_plan(folder, {{{-18, 0, 0}, 11}, {{14, 0, 0}, 8}, {{0, 0, 30}, 6}}, 0.0,
                          R"({"id": "all", "do": "window", "scan": "ct", "low": 0},
      {"id": "right", "do": "parts", "object": "all", "largest": 2},
      {"id": "wrong", "do": "parts", "object": "all", "at_mm": [[-18, 0, 0], [0, 0, 30]]},
      {"id": "one", "do": "parts", "object": "all", "largest": 1})"));
  const Object &all = evaluation.object("all"), &right = evaluation.object("right"),
               &wrong = evaluation.object("wrong"), &one = evaluation.object("one");
  const auto is_followed = [&](const Object& voxels, const Object& mesh) {
    Object made = mesh;
    made.voxel.octree = voxels.voxel.octree;
    const std::size_t before = made.caveats.size();
    settle_choice({[&] { return all.voxel.octree; }, [&] { return *all.mesh.whole; }, all.witness, 2},
                  evaluation.universe, {}, made);
    return made.caveats.size() > before;
  };
  EXPECT_FALSE(is_followed(right, right));
  EXPECT_FALSE(is_followed(wrong, right)) << "the voxels have the smaller part";
  EXPECT_FALSE(is_followed(right, wrong)) << "the mesh has the smaller part";
  EXPECT_FALSE(is_followed(right, one)) << "the mesh has lost a part";
}

}  // namespace
}  // namespace octotomy::planner
