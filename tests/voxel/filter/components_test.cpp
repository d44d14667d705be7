// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/components.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

#include "tests/voxel/dense.h"

namespace octotomy::voxel {
namespace {

// Voxels of each part, in the order of their first voxels, by flooding.
std::vector<std::vector<glm::ivec3>> flooded(const tests::Dense& dense, Neighbours neighbours) {
  const int most = neighbours == Neighbours::Faces ? 1 : neighbours == Neighbours::Edges ? 2 : 3;
  tests::Dense seen(dense.side);
  std::vector<std::vector<glm::ivec3>> parts;
  dense.for_each([&](const glm::ivec3& start) {
    if (dense.at(start) == 0 || seen.at(start) != 0) return;
    std::vector<glm::ivec3> part{start};
    seen.at(start) = 1;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (int step = 0; step < 27; ++step) {
        const glm::ivec3 way(step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
        const glm::ivec3 next = part[i] + way;
        if (way.x * way.x + way.y * way.y + way.z * way.z > most ||
            glm::any(glm::lessThan(next, glm::ivec3(0))) ||
            glm::any(glm::greaterThanEqual(next, glm::ivec3(dense.side))) || dense.at(next) == 0 ||
            seen.at(next) != 0)
          continue;
        seen.at(next) = 1;
        part.push_back(next);
      }
    parts.push_back(part);
  });
  return parts;
}

template <typename Wanted>
tests::Dense union_of(int side, const std::vector<std::vector<glm::ivec3>>& parts, const Wanted& wanted) {
  tests::Dense dense(side);
  for (const std::vector<glm::ivec3>& part : parts)
    if (wanted(part))
      for (const glm::ivec3& v : part) dense.at(v) = 1;
  return dense;
}

TEST(Components, AgreeWithFloodingOnRandomObjectsAndNoise) {
  int several = 0;
  int differ = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const int depth = 2 + static_cast<int>(seed % 4);
    const int side = 1 << depth;
    const tests::Dense dense = tests::random_dense(side, seed + 4000);
    const Universe universe{depth, glm::dmat4(1.0)};
    const Octree octree = tests::octree_of(universe, dense);
    std::vector<std::size_t> part_counts;
    for (const Neighbours neighbours : {Neighbours::Faces, Neighbours::Edges, Neighbours::Corners}) {
      const auto flood = flooded(dense, neighbours);
      std::vector<std::uint64_t> sizes;
      for (const auto& part : flood) sizes.push_back(part.size());
      std::sort(sizes.rbegin(), sizes.rend());
      const Components parts = components(octree, neighbours);
      EXPECT_EQ(parts.voxel_counts, sizes);
      const auto same = [&](const Octree& found, const auto& wanted) {
        return found == tests::octree_of(universe, union_of(side, flood, wanted));
      };
      const std::vector<glm::ivec3>* first = nullptr;
      EXPECT_TRUE(same(parts.largest, [&](const auto& part) {
        if (first == nullptr && part.size() == sizes.front()) first = &part;
        return first == &part;
      }));
      EXPECT_TRUE(same(components_of_at_least(octree, 5, neighbours),
                       [](const auto& part) { return part.size() >= 5; }));
      const std::vector<glm::ivec3> seeds{
          {0, 1, 2}, {side - 1, 2, 1}, {side / 2, side / 2, side / 2}, {-1, 0, 0}};
      EXPECT_TRUE(same(components_at(octree, seeds, neighbours), [&](const auto& part) {
        return std::any_of(seeds.begin(), seeds.end(), [&](const glm::ivec3& seed_voxel) {
          return std::find(part.begin(), part.end(), seed_voxel) != part.end();
        });
      }));
      EXPECT_TRUE(same(components_at_faces(octree, neighbours), [&](const auto& part) {
        return std::any_of(part.begin(), part.end(), [&](const glm::ivec3& v) {
          return glm::any(glm::equal(v, glm::ivec3(0))) || glm::any(glm::equal(v, glm::ivec3(side - 1)));
        });
      }));
      several += sizes.size() > 1;
      part_counts.push_back(sizes.size());
    }
    differ += part_counts[0] > part_counts[1];
  }
  EXPECT_GT(several, 20);
  EXPECT_GT(differ, 5);
}

TEST(Components, TouchingByAnEdgeIsNotTouching) {
  tests::Dense dense(16);
  dense.at({3, 3, 3}) = dense.at({4, 4, 3}) = dense.at({5, 5, 4}) = 1;
  const Components parts = components(tests::octree_of({4, glm::dmat4(1.0)}, dense));
  EXPECT_EQ(parts.voxel_counts, (std::vector<std::uint64_t>{1, 1, 1}));
  EXPECT_TRUE(parts.largest.contains({3, 3, 3}));
  const Octree octree = tests::octree_of({4, glm::dmat4(1.0)}, dense);
  // The third touches the second by a corner only.
  EXPECT_EQ(components(octree, Neighbours::Edges).voxel_counts, (std::vector<std::uint64_t>{2, 1}));
  EXPECT_EQ(components(octree, Neighbours::Corners).voxel_counts, (std::vector<std::uint64_t>{3}));
  dense.at({4, 4, 3}) = 0;
  dense.at({6, 6, 5}) = 1;
  const Octree corner = tests::octree_of({4, glm::dmat4(1.0)}, dense);
  EXPECT_EQ(components(corner, Neighbours::Edges).voxel_counts, (std::vector<std::uint64_t>{1, 1, 1}));
  EXPECT_EQ(components(corner, Neighbours::Corners).voxel_counts, (std::vector<std::uint64_t>{2, 1}));
}

}  // namespace
}  // namespace octotomy::voxel
