// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/certificate/sets_as_given.h"

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "verify/question/random_expression.h"
#include "voxel/solid/combine.h"

namespace octotomy::verify {
namespace {

constexpr brep::Operation operations[] = {brep::Operation::Union, brep::Operation::Intersection,
                                          brep::Operation::Difference};

/// Sets on one lattice share faces and edges wherever they meet.
TEST(SetsAsGiven, BothKernelsAgreeToTheVoxelOnSetsThatShareFaces) {
  voxel::Universe universe;
  universe.depth = 4;
  int answered = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    const voxel::Octree a = random_set(random, universe, 12).octree,
                        b = random_set(random, universe, 12).octree;
    for (const brep::Operation operation : operations) {
      const SetsAnswer answer = certify_sets(a, operation, b);
      EXPECT_NE(answer.certificate.verdict, Verdict::Fail)
          << "seed " << seed << ": " << answer.certificate.reasons.front();
      if (!answer.solid) continue;
      ++answered;
      EXPECT_EQ(answer.certificate.voxel.volume_mm3, answer.certificate.mesh.volume_mm3) << "seed " << seed;
    }
  }
  EXPECT_EQ(answered, 24);
}

/// Three sets, each operator, and complements: no two planes of one set differ from another's.
TEST(SetsAsGiven, ExpressionsOfSetsThatShareFacesAndEdgesAreTheSameInBothKernels) {
  voxel::Universe universe;
  universe.depth = 2;
  int answered = 0, of_substance = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    std::vector<voxel::Octree> sets;
    for (int i = 0; i < 3; ++i) sets.push_back(random_set(random, universe, 3).octree);
    const std::string expression =
        text(random_tree(random, {.depth = 4, .leaves = 4, .names = 3, .xors = 1}),
             [](int leaf) { return std::string(1, static_cast<char>('a' + leaf)); });
    const SetsAnswer answer = certify_sets(
        expression, [&](std::string_view name) { return sets[static_cast<std::size_t>(name[0] - 'a')]; });
    ASSERT_NE(answer.certificate.verdict, Verdict::Fail)
        << "seed " << seed << ": " << expression << ": " << answer.certificate.reasons.front();
    if (!answer.solid) continue;
    ++answered;
    ASSERT_EQ(answer.certificate.voxel.volume_mm3, answer.certificate.mesh.volume_mm3)
        << "seed " << seed << ": " << expression;
    of_substance += !answer.octree.is_empty() && answer.octree != sets[0];
  }
  EXPECT_EQ(answered, 60);
  EXPECT_GE(of_substance, 30);
}

TEST(SetsAsGiven, VoxelsAndHolesThatMeetAtAnEdgeOrACornerAreCombinedWithTheVoxelBetweenThem) {
  voxel::Universe universe;
  universe.depth = 2;
  const voxel::Lattice lattice = universe.lattice();
  const auto box = [&](const glm::dvec3& low, const glm::dvec3& high) {
    return voxel::Expression(voxel::Box{lattice.lps_mm(low - 0.5), lattice.lps_mm(high + 0.5)});
  };
  const voxel::Octree between = voxel::combine(universe, box({2, 1, 1}, {2, 1, 1}));
  for (const glm::dvec3& other : {glm::dvec3(2, 2, 1), glm::dvec3(2, 2, 2)}) {
    const voxel::Expression pair = box({1, 1, 1}, {1, 1, 1}) | box(other, other);
    const SetsAnswer voxels = certify_sets(voxel::combine(universe, pair), brep::Operation::Union, between);
    ASSERT_TRUE(voxels.solid);
    EXPECT_EQ(voxels.certificate.verdict, Verdict::Pass);
    EXPECT_EQ(voxels.certificate.mesh.volume_mm3, 3.0);
    // A sheet around a hole must not move towards the other hole.
    const SetsAnswer holes = certify_sets(voxel::combine(universe, box({0, 0, 0}, {3, 3, 3}) - pair),
                                          brep::Operation::Difference, between);
    ASSERT_TRUE(holes.solid);
    EXPECT_EQ(holes.certificate.verdict, Verdict::Pass);
    EXPECT_EQ(holes.certificate.mesh.volume_mm3, 61.0);
  }
}

TEST(SetsAsGiven, BoxesWithOneFaceInCommonKeepTheirVolumes) {
  voxel::Universe universe;
  universe.depth = 4;
  const auto box = [&](const glm::dvec3& low, const glm::dvec3& high) {
    const voxel::Lattice lattice = universe.lattice();
    return voxel::combine(universe, voxel::Box{lattice.lps_mm(low - 0.5), lattice.lps_mm(high - 0.5)});
  };
  const voxel::Octree a = box({2, 2, 2}, {8, 8, 8}), beside = box({8, 2, 2}, {12, 8, 8}),
                      within = box({2, 2, 2}, {8, 8, 5});
  EXPECT_EQ(certify_sets(a, brep::Operation::Union, beside).certificate.mesh.volume_mm3, 360.0);
  EXPECT_EQ(certify_sets(a, brep::Operation::Intersection, beside).certificate.mesh.volume_mm3, 0.0);
  EXPECT_EQ(certify_sets(a, brep::Operation::Difference, within).certificate.mesh.volume_mm3, 108.0);
  EXPECT_EQ(certify_sets(a, brep::Operation::Difference, a).certificate.mesh.volume_mm3, 0.0);
}

}  // namespace
}  // namespace octotomy::verify
