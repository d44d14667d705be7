// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/projection.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

/// The columns of a plain array.
Projection projection_of(const tests::Dense& dense, Direction from) {
  const int axis = static_cast<int>(from) / 2;
  const bool from_high = static_cast<int>(from) % 2 == 0;
  Projection projection{dense.side, {}, 0};
  for (int j = 0; j < dense.side; ++j)
    for (int i = 0; i < dense.side; ++i) {
      std::int32_t before = -1;
      for (int d = 0; d < dense.side && before < 0; ++d) {
        glm::ivec3 v;
        v[axis == 0 ? 1 : 0] = i;
        v[axis == 2 ? 1 : 2] = j;
        v[axis] = from_high ? dense.side - 1 - d : d;
        if (dense.at(v) != 0) before = d;
      }
      projection.before.push_back(before);
    }
  return projection;
}

TEST(Projection, OfEveryCodeShowsTheFirstVoxelsOfAPlainArray) {
  tests::for_each_subject([](const tests::Dense& dense, const Octree& octree) {
    for (int number = 0; number < direction_count; ++number) {
      const auto from = static_cast<Direction>(number);
      const Projection expected = projection_of(dense, from);
      ASSERT_TRUE(projection(cuberille_faces(octree), from) == expected) << "faces, direction " << number;
      ASSERT_TRUE(projection(binary_array(octree), from) == expected) << "array, direction " << number;
      ASSERT_TRUE(projection(run_length(octree), from) == expected) << "runs, direction " << number;
      ASSERT_TRUE(projection(segment_index(octree), from) == expected) << "segments, direction " << number;
    }
  });
}

TEST(Projection, ReadsTheElementsThatItsAlgorithmNeeds) {
  // A full cube: one face a column, all voxels, one run, and segments of the first layer alone.
  const Octree full = Octree::full(tests::universe_of(3));
  EXPECT_EQ(projection(cuberille_faces(full), Direction::MinusY).visited, 64U);
  EXPECT_EQ(projection(binary_array(full), Direction::MinusY).visited, 512U);
  EXPECT_EQ(projection(run_length(full), Direction::MinusY).visited, 1U);
  EXPECT_EQ(projection(segment_index(full), Direction::MinusY).visited, 8U);
  EXPECT_EQ(projection(segment_index(full), Direction::PlusX).visited, 64U);
}

}  // namespace
}  // namespace octotomy::voxel
