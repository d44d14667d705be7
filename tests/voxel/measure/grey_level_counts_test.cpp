// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/grey_level_counts.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

struct Grey {
  int side;
  voxel::Int16Samples samples;
};

void count(const Grey& grey, std::int16_t background, const glm::ivec3& origin, int side, int level,
           std::vector<LevelCount>& levels) {
  const auto at = [&](int x, int y, int z) {
    return grey.samples[static_cast<std::size_t>(origin.x + x +
                                                 grey.side * (origin.y + y + grey.side * (origin.z + z)))];
  };
  const std::int16_t first = at(0, 0, 0);
  bool alike = true;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) alike = alike && at(x, y, z) == first;
  if (level > 0) {
    LevelCount& own = levels[static_cast<std::size_t>(level - 1)];
    ++(!alike ? own.partial : first == background ? own.empty : own.full);
  }
  if (alike) return;
  for (int k = 0; k < 8; ++k)
    count(grey, background, origin + glm::ivec3(k & 1, (k >> 1) & 1, k >> 2) * (side / 2), side / 2,
          level + 1, levels);
}

TEST(GreyLevelCounts, AreThoseOfThePlainGreyOctree) {
  for (int depth = 2; depth <= 6; ++depth)
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      SCOPED_TRACE("depth " + std::to_string(depth) + ", seed " + std::to_string(seed));
      const int side = 1 << depth;
      const tests::Dense bone = tests::random_dense(side, seed);
      const tests::Dense skin = tests::random_dense(side, seed + 50);
      Grey grey{side, {}};
      for (std::size_t i = 0; i < bone.voxels.size(); ++i)
        grey.samples.push_back(
            static_cast<std::int16_t>(-1024 + 1000 * skin.voxels[i] + 700 * bone.voxels[i]));
      Scene scene;
      scene.lattice = tests::universe_of(depth).lattice();
      scene.samples = grey.samples;
      const std::vector<LevelCount> levels = level_counts(grey_octree_of(tests::universe_of(depth), scene));
      std::vector<LevelCount> expected(static_cast<std::size_t>(depth));
      count(grey, -1024, glm::ivec3(0), side, 0, expected);
      ASSERT_EQ(levels.size(), expected.size());
      for (std::size_t i = 0; i < levels.size(); ++i) {
        EXPECT_EQ(levels[i].level, static_cast<int>(i) + 1);
        EXPECT_EQ(levels[i].partial, expected[i].partial) << "level " << i + 1;
        EXPECT_EQ(levels[i].full, expected[i].full) << "level " << i + 1;
        EXPECT_EQ(levels[i].empty, expected[i].empty) << "level " << i + 1;
      }
    }
}

}  // namespace
}  // namespace octotomy::voxel
