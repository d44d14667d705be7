// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/tree/slice_build.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;

TEST(SliceBuild, VisitsTheSlicesThatHoldAVoxelAndBuildsTheSameTreeOfThem) {
  tests::for_each_subject([](const Dense& dense, const Octree& octree) {
    const std::vector<bool> occupied = occupied_slices(octree);
    const auto area = static_cast<std::ptrdiff_t>(dense.side) * dense.side;
    for (int z = 0; z < dense.side; ++z) {
      const auto slice = dense.voxels.begin() + z * area;
      ASSERT_EQ(occupied[static_cast<std::size_t>(z)], std::find(slice, slice + area, 1) != slice + area);
    }
    std::vector<SliceBits> slices(static_cast<std::size_t>(dense.side));
    int last = -1;
    for_each_slice(octree, [&](int z, const SliceBits& slice) {
      ASSERT_GT(z, last);
      last = z;
      slices[static_cast<std::size_t>(z)] = slice;
    });
    const Octree built = octree_of_slices(octree.universe(), [&](int z, SliceBits& slice) {
      for (const std::uint64_t word : slice.words) EXPECT_EQ(word, 0U) << "slice " << z << " is not empty";
      if (slices[static_cast<std::size_t>(z)].words.empty()) return false;
      slice.words = slices[static_cast<std::size_t>(z)].words;
      return true;
    });
    ASSERT_TRUE(built == octree);
  });
}

TEST(SliceBuild, RunsOfARowEndWhereItDoes) {
  SliceBits slice;
  slice.side = 256;
  slice.words_per_row = 4;
  slice.words.assign(4 * 256, 0);
  set_row(slice, 7, 60, 70);
  set_row(slice, 7, 128, 191);
  set_row(slice, 7, 255, 255);
  std::vector<std::pair<int, int>> runs;
  for (int first = 0, last = -1; next_run(slice, 7, last + 1, first, last);) runs.emplace_back(first, last);
  EXPECT_EQ(runs, (std::vector<std::pair<int, int>>{{60, 70}, {128, 191}, {255, 255}}));
  int first = 0;
  int last = 0;
  EXPECT_FALSE(next_run(slice, 6, 0, first, last));
  set_row(slice, 6, 0, 255);
  ASSERT_TRUE(next_run(slice, 6, 0, first, last));
  EXPECT_EQ(std::make_pair(first, last), std::make_pair(0, 255));
}

}  // namespace
}  // namespace octotomy::voxel
