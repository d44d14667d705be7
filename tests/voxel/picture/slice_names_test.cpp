// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/picture/slice_names.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

using Paths = std::vector<std::filesystem::path>;

/// Expects the order in which the names stand, whatever the order in which they come.
SliceNames expect_order(const Paths& names) {
  Paths mixed = names;
  std::sort(mixed.begin(), mixed.end());
  SliceNames found;
  for (int turn = 0; turn < 2; ++turn) {
    found = ordered_by_name(mixed);
    EXPECT_EQ(found.files, names);
    std::reverse(mixed.begin(), mixed.end());
  }
  return found;
}

TEST(SliceNames, NumbersAreComparedAsNumbers) {
  EXPECT_TRUE(expect_order({"slice2.png", "slice10.png", "slice011.png"}).doubts.empty());
  expect_order({"a1_2.png", "a1_10.png", "a2_1.png", "b1_1.png"});
  expect_order({"00000000000000000009.tif", "10000000000000000000.tif"});
  EXPECT_TRUE(expect_order({"a.png", "b.png"}).doubts.empty());
}

TEST(SliceNames, AMinusWhereOthersHaveNoneIsASign) {
  const SliceNames positions =
      expect_order({"z_-10.0.png", "z_-2.5.png", "z_0.0.png", "z_2.5.png", "z_10.0.png"});
  EXPECT_TRUE(positions.doubts.empty());
  EXPECT_EQ(positions.number.front(), -10.0);
  EXPECT_EQ(positions.number[3], 2.5);
  EXPECT_TRUE(
      expect_order({"slice_-1.5.png", "slice_-0.png", "slice_+1.5.png", "slice_+3.png"}).doubts.empty());
  EXPECT_TRUE(expect_order({"-2.png", "-1.png", "1.png"}).doubts.empty());
  // Behind a letter it is no more than likely.
  const SliceNames behind_letter = expect_order({"z-10.png", "z-9.png", "z0.png", "z9.png"});
  ASSERT_EQ(behind_letter.doubts.size(), 1u);
  EXPECT_NE(behind_letter.doubts[0].find("minus"), std::string::npos);
}

TEST(SliceNames, AMinusThatOnlySeparatesIsNone) {
  EXPECT_TRUE(expect_order({"head-2.png", "head-9.png", "head-10.png"}).doubts.empty());
  EXPECT_TRUE(expect_order({"2024-01-05.png", "2024-01-06.png", "2024-02-01.png"}).doubts.empty());
  EXPECT_TRUE(expect_order({"sub-01_z_-5.png", "sub-01_z_5.png", "sub-02_z_-5.png"}).doubts.empty());
  EXPECT_TRUE(expect_order({"a 1 - 2.png", "a 1 - 10.png"}).doubts.empty());
  EXPECT_EQ(expect_order({"head-2.png", "head-9.png"}).number.front(), 2.0);
}

TEST(SliceNames, AMinusInEveryNameIsASignWithADoubt) {
  const SliceNames below = expect_order({"z_-30.png", "z_-20.png", "z_-10.png"});
  ASSERT_EQ(below.doubts.size(), 1u);
  EXPECT_NE(below.doubts[0].find("each name has a minus"), std::string::npos);
  EXPECT_TRUE(ordered_by_name({"z_-30.png"}).doubts.empty()) << "one file has one order";
}

TEST(SliceNames, ADotIsADecimalPointWhereItsDigitsAllowThat) {
  EXPECT_TRUE(expect_order({"z_-10.50.png", "z_-10.25.png", "z_10.25.png", "z_10.50.png"}).doubts.empty());
  const SliceNames shortened = expect_order({"z1.png", "z1.25.png", "z1.5.png", "z1.75.png", "z2.0.png"});
  ASSERT_EQ(shortened.doubts.size(), 1u);
  EXPECT_NE(shortened.doubts[0].find("decimal point"), std::string::npos);
  // Series and image: no program writes both 1.1 and 1.10 for one length.
  EXPECT_TRUE(expect_order({"1.1.png", "1.2.png", "1.9.png", "1.10.png", "1.11.png"}).doubts.empty());
  expect_order({"1.2.840.9.png", "1.2.840.10.png"});
}

TEST(SliceNames, StacksInOneFolderAreNamedAndSignsAreNoStack) {
  EXPECT_EQ(stacks_named({"ct_1.png", "ct_2.png", "mask_1.png", "mask_2.png"}),
            "ct_#.png (2 files) and mask_#.png (2 files)");
  EXPECT_EQ(stacks_named({"ct_1.png", "ct_2.png", "mask_3.png"}), "");
  EXPECT_EQ(stacks_named({"z_-10.png", "z_-5.png", "z_5.png", "z_10.png", "z_+15.png"}), "");
  EXPECT_NE(numbered_alike(ordered_by_name({"s1_000.png", "s1_001.png", "s2_000.png", "s2_001.png"})), "");
  EXPECT_EQ(numbered_alike(ordered_by_name({"s1_000.png", "s1_001.png", "s2_002.png", "s2_003.png"})), "");
}

}  // namespace
}  // namespace octotomy::voxel
