// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/exact_agreement.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "brep/mesh/move.h"
#include "brep/mesh/triangles.h"
#include "verify/question/random_expression.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

voxel::Universe universe_of(int depth) {
  voxel::Universe universe;
  universe.depth = depth;
  return universe;
}

struct Case {
  voxel::Expression expression;
  std::string told;
};

Case random_case(std::uint64_t seed, int depth, int side, const RandomTreeOptions& options) {
  Random random(seed);
  const voxel::Universe universe = universe_of(depth);
  std::vector<voxel::Octree> sets;
  std::string told = "seed " + std::to_string(seed) + ": ";
  for (int i = 0; i < options.names; ++i) {
    RandomSet set = random_set(random, universe, side);
    sets.push_back(set.octree);
    told += set.recipe + ", ";
  }
  const std::string words =
      text(random_tree(random, options), [](int i) { return std::string(1, static_cast<char>('a' + i)); });
  voxel::Names names;
  names.object = [&](std::string_view name) {
    return voxel::Expression(sets[static_cast<std::size_t>(name[0] - 'a')]);
  };
  return {voxel::parse_expression(words, names), told + words};
}

std::string why(const Certificate& certificate) {
  std::string all = certificate.operation;
  for (const std::string& reason : certificate.reasons) all += "; " + reason;
  return all;
}

TEST(ExactAgreement, HoldsForExpressionsOfAnySetsOfVoxelsNoiseIncluded) {
  int of_substance = 0, in_pieces = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Case tested = random_case(seed, 3, 7, {.depth = 6, .leaves = 5, .names = 3});
    const ExactAnswers answers = exact_answers(tested.expression);
    const Certificate certificate = certify_exact(answers);
    EXPECT_EQ(certificate.verdict, Verdict::Pass) << tested.told << ": " << why(certificate);
    of_substance += !answers.octree.is_empty();
    in_pieces += answers.solids.size() > 1;
  }
  EXPECT_GT(of_substance, 30);
  EXPECT_GT(in_pieces, 5);
}

TEST(ExactAgreement, HoldsUnderMotionsByWholeVoxelsThatPushSetsOutOfTheUniverse) {
  Random random(5);
  const voxel::Universe universe = universe_of(3);
  int cut = 0;
  for (int i = 0; i < 8; ++i) {
    const voxel::Octree a = random_set(random, universe, 8).octree,
                        b = random_set(random, universe, 8).octree;
    glm::dmat4 motion(1.0);
    motion[3] =
        glm::dvec4(random_int(random, -5, 5), random_int(random, -5, 5), random_int(random, -5, 5), 1);
    const auto shifted = voxel::moved(voxel::Expression(a) | voxel::Expression(b), motion);
    const ExactAnswers answers = exact_answers(shifted - ~voxel::Expression(b));
    EXPECT_EQ(certify_exact(answers).verdict, Verdict::Pass) << i << why(certify_exact(answers));
    const ExactAnswers whole = exact_answers(shifted);
    EXPECT_EQ(certify_exact(whole).verdict, Verdict::Pass) << i << why(certify_exact(whole));
    cut += 8 * whole.octree.voxel_count() < 8 * exact_answers(voxel::Expression(a) | b).octree.voxel_count();
  }
  EXPECT_GT(cut, 3);
}

TEST(ExactAgreement, KeepsTheShapeOfASetThatFillsItsVoxelsToThreeQuarters) {
  Random random(1);
  const ExactAnswers answers = exact_answers(voxel::Octree::full(universe_of(3)));
  // 8 voxels a side lose a quarter of one at either end; refined four times.
  EXPECT_EQ(answers.octree.voxel_count(), 30U * 30 * 30);
  EXPECT_DOUBLE_EQ(answers.unit_mm3, 1.0 / 64.0);
}

class SpoiledAnswers : public testing::Test {
 protected:
  ExactAnswers answers(const std::string& words) const {
    voxel::Names names;
    names.object = [this](std::string_view name) { return name == "a" ? a_ : b_; };
    return exact_answers(voxel::parse_expression(words, names));
  }
  void expect_fails(const ExactAnswers& answers) const {
    EXPECT_EQ(certify_exact(answers).verdict, Verdict::Fail);
  }

  Random random_{3};
  voxel::Universe universe_ = universe_of(3);
  voxel::Octree a_ = random_set(random_, universe_, 8).octree;
  voxel::Octree b_ = random_set(random_, universe_, 8).octree;
};

TEST_F(SpoiledAnswers, PassUnspoiled) {
  EXPECT_EQ(certify_exact(answers("a - b")).verdict, Verdict::Pass);
}

TEST_F(SpoiledAnswers, FailWhereOperandsWereSwapped) {
  ExactAnswers spoiled = answers("a - b");
  spoiled.solids = answers("b - a").solids;
  expect_fails(spoiled);
}

TEST_F(SpoiledAnswers, FailWhereOneRefinedVoxelIsMissing) {
  ExactAnswers spoiled = answers("a - b");
  const voxel::Octree one = answers("a & ~a").octree;  // another shift of a: something, and little
  ASSERT_FALSE(one.is_empty());
  spoiled.octree = voxel::combine(spoiled.octree.universe(), voxel::Expression(spoiled.octree) - one);
  expect_fails(spoiled);
}

TEST_F(SpoiledAnswers, FailWhereTheMeshIsMovedTurnedRoundOpenOrTwice) {
  const ExactAnswers whole = answers("a | b");
  ASSERT_EQ(whole.solids.size(), 1U);
  ExactAnswers spoiled = whole;
  glm::dmat4 motion(1.0);
  motion[3] = glm::dvec4(0, 0, 1, 1);
  spoiled.solids[0] = brep::moved(whole.solids[0], motion);
  expect_fails(spoiled);

  brep::Triangles triangles = brep::triangles_of(whole.solids[0]);
  for (auto& face : triangles.faces) std::swap(face[0], face[1]);
  spoiled.solids[0] = brep::mesh_of(triangles);
  expect_fails(spoiled);

  triangles = brep::triangles_of(whole.solids[0]);
  triangles.faces.pop_back();
  spoiled.solids[0] = brep::mesh_of(triangles);
  expect_fails(spoiled);

  spoiled.solids = {whole.solids[0], whole.solids[0]};
  expect_fails(spoiled);
}

TEST(ExactAgreement, RefusesWhatIsNotTheSameInBothKernels) {
  const voxel::Octree full = voxel::Octree::full(universe_of(3));
  EXPECT_THROW(exact_answers(voxel::Expression(full) & voxel::Sphere{}), std::invalid_argument);
  EXPECT_THROW(exact_answers(voxel::Expression(full) & voxel::Octree::full(universe_of(4))),
               std::invalid_argument);
  glm::dmat4 motion(1.0);
  motion[3].x = 0.5;
  EXPECT_THROW(exact_answers(voxel::moved(voxel::Expression(full), motion)), std::invalid_argument);
}

TEST(ExactAgreement, HasTheSameBitsOnOneThreadAndMany) {
  const Case tested = random_case(4, 3, 8, {.depth = 3, .leaves = 3, .names = 3});
  const Certificate many = certify_exact(exact_answers(tested.expression));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Certificate single = certify_exact(exact_answers(tested.expression));
  EXPECT_EQ(many.mesh.volume_mm3, single.mesh.volume_mm3);
  EXPECT_EQ(many.mesh.area_mm2, single.mesh.area_mm2);
}

TEST(WholeVolume, IsAnIntegerAlsoOfSolidsWhosePointsAreNot) {
  // A unit cube, one of whose edges has a point at a third of it.
  brep::Triangles cube;
  const double third = 1.0 / 3.0;
  cube.points_mm = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {9, 9, 0},    {0, 0, 9},
                    {9, 0, 9}, {0, 9, 9}, {9, 9, 9}, {third, 0, 0}};
  cube.faces = {{0, 2, 8}, {8, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 8, 4}, {8, 1, 5},
                {8, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  EXPECT_EQ(whole_volume({brep::mesh_of(cube)}), 729);
  cube.points_mm[7].x = 9.1;
  EXPECT_EQ(whole_volume({brep::mesh_of(cube)}), std::nullopt);
}

}  // namespace
}  // namespace octotomy::verify
