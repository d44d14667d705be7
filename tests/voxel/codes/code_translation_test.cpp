// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/code_translation.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

tests::Dense moved_array(const tests::Dense& dense, const glm::ivec3& by) {
  tests::Dense moved(dense.side);
  dense.for_each([&](const glm::ivec3& v) {
    const glm::ivec3 to = v + by;
    if (glm::all(glm::greaterThanEqual(to, glm::ivec3(0))) &&
        glm::all(glm::lessThan(to, glm::ivec3(dense.side))))
      moved.at(to) = dense.at(v);
  });
  return moved;
}

TEST(CodeTranslation, IsThatOfAPlainArrayInEveryCode) {
  int cut_off = 0, whole = 0;
  tests::for_each_subject([&](const tests::Dense& dense, const Octree& octree) {
    for (const glm::ivec3& by :
         {glm::ivec3(1, 0, 0), glm::ivec3(0, -1, 2), glm::ivec3(-2, 3, -1), glm::ivec3(0, 0, 70)}) {
      const Octree expected = tests::octree_of(octree.universe(), moved_array(dense, by));
      ASSERT_EQ(translated(marginal_index(octree), by).slices, marginal_index(expected).slices);
      ASSERT_EQ(translated(segment_index(octree), by).slices, segment_index(expected).slices);
      ASSERT_EQ(translated(run_length(octree), by).runs, run_length(expected).runs);
      if (expected.voxel_count() == octree.voxel_count()) {
        ++whole;
        ASSERT_EQ(translated(cuberille_faces(octree), by).lists, cuberille_faces(expected).lists);
      } else {
        ++cut_off;
        ASSERT_THROW(translated(cuberille_faces(octree), by), std::invalid_argument);
      }
    }
  });
  EXPECT_GT(whole, 10);
  EXPECT_GT(cut_off, 10);
}

}  // namespace
}  // namespace octotomy::voxel
