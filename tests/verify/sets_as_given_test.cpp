// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/sets_as_given.h"

#include <gtest/gtest.h>

#include "verify/random_expression.h"
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
      // The mesh kernel may have no manifold answer, and says so; it is never wrong.
      EXPECT_NE(answer.certificate.verdict, Verdict::Fail)
          << "seed " << seed << ": " << answer.certificate.reasons.front();
      if (!answer.solid) continue;
      ++answered;
      EXPECT_EQ(answer.certificate.voxel.volume_mm3, answer.certificate.mesh.volume_mm3) << "seed " << seed;
    }
  }
  EXPECT_GE(answered, 6) << "of 24";
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
