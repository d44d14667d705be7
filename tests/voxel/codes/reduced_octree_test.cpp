// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/reduced_octree.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;

/// One level less, voxel by voxel.
Dense halved(const Dense& dense, double share) {
  Dense half(dense.side / 2);
  half.for_each([&](const glm::ivec3& v) {
    int full = 0;
    for (int k = 0; k < 8; ++k) full += dense.at(2 * v + glm::ivec3(k & 1, (k >> 1) & 1, k >> 2));
    half.at(v) = full > 8.0 * share;
  });
  return half;
}

TEST(ReducedOctree, IsThePlainArrayHalvedLevelByLevel) {
  tests::for_each_subject([](const Dense& dense, const Octree& octree) {
    for (const double share : {0.0, 0.3, 0.5, 0.9}) {
      Dense expected = dense;
      for (int levels = 1; octree.universe().depth - levels >= 2; ++levels) {
        expected = halved(expected, share);
        const Octree found = reduced(octree, levels, {Reduction::Of::Children, share});
        ASSERT_EQ(tests::dense_of(found).voxels, expected.voxels) << levels << " levels, share " << share;
      }
    }
  });
}

TEST(ReducedOctree, OfAllVoxelsCountsThem) {
  tests::for_each_subject([](const Dense& dense, const Octree& octree) {
    if (octree.universe().depth < 4) return;
    const Octree found = reduced(octree, 2, {Reduction::Of::Voxels, 0.5});
    tests::dense_of(found).for_each([&](const glm::ivec3& v) {
      int full = 0;
      for (int k = 0; k < 64; ++k) full += dense.at(4 * v + glm::ivec3(k & 3, (k >> 2) & 3, k >> 4));
      ASSERT_EQ(found.contains(v), full > 32);
    });
  });
}

TEST(ReducedOctree, StaysAtItsPlace) {
  Universe universe = tests::universe_of(4);
  universe.lps_from_voxel[0][0] = 0.5;
  universe.lps_from_voxel[3] = {10.0, 20.0, 30.0, 1.0};
  const Octree found = reduced(Octree::full(universe), 2);
  const Box before = bounds(universe.lattice()), after = bounds(found.universe().lattice());
  EXPECT_EQ(before.low_mm, after.low_mm);
  EXPECT_EQ(before.high_mm, after.high_mm);
  EXPECT_TRUE(reduced(Octree::full(universe), 0) == Octree::full(universe));
}

TEST(ReducedOctree, ThatWouldHaveNoLevelsIsRefused) {
  const Octree octree = Octree::full(tests::universe_of(4));
  EXPECT_NE(tests::refusal([&] { reduced(octree, 3); }).find("leave fewer than two"), std::string::npos);
  EXPECT_NE(tests::refusal([&] {
              reduced(octree, 1, {Reduction::Of::Voxels, 1.5});
            }).find("0..1"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::voxel
