// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/boundary_track.h"

#include <gtest/gtest.h>
#include <map>
#include <set>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;
using tests::universe_of;

bool inside(const Dense& dense, const glm::ivec3& v) {
  return glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) &&
         glm::all(glm::lessThan(v, glm::ivec3(dense.side))) && dense.at(v) != 0;
}

// Labels of the 18-connected parts of the object and the 6-connected parts of the background, by flooding a
// grid that is one voxel larger on every side, as the background surrounds the universe.
std::map<std::array<int, 3>, int> parts(const Dense& dense) {
  std::map<std::array<int, 3>, int> labels;
  int next = 0;
  for (int z = -1; z <= dense.side; ++z)
    for (int y = -1; y <= dense.side; ++y)
      for (int x = -1; x <= dense.side; ++x) {
        if (labels.contains({x, y, z})) continue;
        const bool object = inside(dense, {x, y, z});
        std::vector<glm::ivec3> open{{x, y, z}};
        labels[{x, y, z}] = next;
        while (!open.empty()) {
          const glm::ivec3 v = open.back();
          open.pop_back();
          for (int k = 0; k < 27; ++k) {
            const glm::ivec3 d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
            const int steps = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
            if (steps == 0 || steps > (object ? 2 : 1)) continue;
            const glm::ivec3 n = v + d;
            if (glm::any(glm::lessThan(n, glm::ivec3(-1))) ||
                glm::any(glm::greaterThan(n, glm::ivec3(dense.side))))
              continue;
            if (inside(dense, n) != object || !labels.insert({{n.x, n.y, n.z}, next}).second) continue;
            open.push_back(n);
          }
        }
        ++next;
      }
  return labels;
}

TEST(BoundaryTrack, FindsExactlyTheFacesBetweenOneObjectAndOneBackground) {
  int boundaries = 0;
  int inner = 0;
  for (int depth = 2; depth <= 4; ++depth)
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
      SCOPED_TRACE("depth " + std::to_string(depth) + ", seed " + std::to_string(seed));
      Dense dense = tests::random_dense(1 << depth, seed);
      // Every third is noise, which has parts within parts.
      if (seed % 3 == 0) {
        std::mt19937_64 random(seed);
        for (std::uint8_t& voxel : dense.voxels) voxel = random() % 4 != 0;
      }
      const Octree octree = tests::octree_of(universe_of(depth), dense);
      auto labels = parts(dense);
      // All exposed faces by the two parts that they lie between.
      std::map<std::pair<int, int>, CuberilleFaces> expected;
      const CuberilleFaces all = cuberille_faces(octree);
      std::map<std::pair<int, int>, Face> seeds;
      for (std::size_t number = 0; number < direction_count; ++number)
        for (const glm::ivec3& v : all.lists[number]) {
          const glm::ivec3 n = v + step(static_cast<Direction>(number));
          const std::pair between{labels[{v.x, v.y, v.z}], labels[{n.x, n.y, n.z}]};
          expected[between].lists[number].push_back(v);
          seeds[between] = {v, static_cast<Direction>(number)};
        }
      std::size_t tracked_faces = 0;
      for (const auto& [between, seed_face] : seeds) {
        const CuberilleFaces tracked = track_boundary(octree, seed_face);
        ASSERT_EQ(tracked.lists, expected[between].lists);
        tracked_faces += tracked.face_count();
        ++boundaries;
        inner += between.second != 0;
      }
      EXPECT_EQ(tracked_faces, all.face_count());
    }
  EXPECT_GT(boundaries, 300);
  EXPECT_GT(inner, 50);
}

TEST(BoundaryTrack, Figure31IsOneBoundaryThoughThreeFaceConnectedParts) {
  const Octree octree = tests::figure_3_1();
  const CuberilleFaces all = cuberille_faces(octree);
  for (std::size_t number = 0; number < direction_count; ++number)
    for (const glm::ivec3& v : all.lists[number])
      ASSERT_EQ(track_boundary(octree, {v, static_cast<Direction>(number)}).lists, all.lists);
}

TEST(BoundaryTrack, LeavesOutVoxelsThatTouchByACornerOnly) {
  Dense dense(4);
  dense.at({1, 1, 1}) = dense.at({2, 2, 2}) = 1;
  const Octree octree = tests::octree_of(universe_of(2), dense);
  EXPECT_EQ(track_boundary(octree, {{1, 1, 1}, Direction::PlusX}).face_count(), 6U);
  dense.at({2, 2, 1}) = 1;  // an edge to the first, a face to the second
  EXPECT_EQ(
      track_boundary(tests::octree_of(universe_of(2), dense), {{1, 1, 1}, Direction::PlusX}).face_count(),
      16U);
}

TEST(BoundaryTrack, WalksRoundABallInTheLargestUniverse) {
  const Universe universe = universe_of(12);
  const Octree ball = combine(universe, Sphere{{4095, 2048, 2048}, 20.0});
  const Face seed{{4095, 2048, 2048}, Direction::PlusX};
  EXPECT_EQ(track_boundary(ball, seed).lists, cuberille_faces(ball).lists);
}

TEST(BoundaryTrack, RefusesASeedThatIsNotExposed) {
  const Octree octree = tests::figure_3_1();
  EXPECT_TRUE(is_boundary(octree, {{0, 2, 0}, Direction::MinusX}));
  EXPECT_FALSE(is_boundary(octree, {{0, 2, 0}, Direction::PlusX}));
  EXPECT_FALSE(is_boundary(octree, {{0, 0, 0}, Direction::PlusX}));
  EXPECT_NE(tests::refusal([&] {
              track_boundary(octree, {{0, 2, 0}, Direction::PlusX});
            }).find("(0,2,0)"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::voxel
