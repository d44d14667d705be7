// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/components.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

#include "tests/voxel/dense.h"

namespace octotomy::voxel {
namespace {

// Sizes of the 6-connected parts by flooding, largest first, and the voxels of the first largest one.
std::pair<std::vector<std::uint64_t>, tests::Dense> flooded(const tests::Dense& dense) {
  tests::Dense seen(dense.side);
  tests::Dense largest(dense.side);
  std::vector<std::uint64_t> sizes;
  dense.for_each([&](const glm::ivec3& start) {
    if (dense.at(start) == 0 || seen.at(start) != 0) return;
    std::vector<glm::ivec3> part{start};
    seen.at(start) = 1;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1}) {
          glm::ivec3 next = part[i];
          next[axis] += side;
          if (next[axis] < 0 || next[axis] >= dense.side || dense.at(next) == 0 || seen.at(next) != 0)
            continue;
          seen.at(next) = 1;
          part.push_back(next);
        }
    if (sizes.empty() || part.size() > *std::max_element(sizes.begin(), sizes.end())) {
      largest = tests::Dense(dense.side);
      for (const glm::ivec3& v : part) largest.at(v) = 1;
    }
    sizes.push_back(part.size());
  });
  std::sort(sizes.rbegin(), sizes.rend());
  return {sizes, largest};
}

TEST(Components, AgreeWithFloodingOnRandomObjectsAndNoise) {
  int several = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const int depth = 2 + static_cast<int>(seed % 4);
    const tests::Dense dense = tests::random_dense(1 << depth, seed + 4000);
    const Universe universe{depth, glm::dmat4(1.0)};
    const auto [sizes, largest] = flooded(dense);
    const Components parts = components(tests::octree_of(universe, dense));
    EXPECT_EQ(parts.voxel_counts, sizes);
    EXPECT_TRUE(parts.largest == tests::octree_of(universe, largest));
    several += sizes.size() > 1;
  }
  EXPECT_GT(several, 20);
}

TEST(Components, TouchingByAnEdgeIsNotTouching) {
  tests::Dense dense(16);
  dense.at({3, 3, 3}) = dense.at({4, 4, 3}) = dense.at({5, 5, 4}) = 1;
  const Components parts = components(tests::octree_of({4, glm::dmat4(1.0)}, dense));
  EXPECT_EQ(parts.voxel_counts, (std::vector<std::uint64_t>{1, 1, 1}));
  EXPECT_TRUE(parts.largest.contains({3, 3, 3}));
}

}  // namespace
}  // namespace octotomy::voxel
