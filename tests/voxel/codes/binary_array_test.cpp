// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/binary_array.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

// Section 3.2.1.
const std::string binary_array_of_figure =
    "Slice 0 :\n0 0 0 0\n0 0 0 0\n1 1 0 0\n1 1 0 0\n"
    "Slice 1 :\n0 0 0 0\n0 0 0 1\n1 1 1 0\n1 1 0 0\n"
    "Slice 2 :\n0 0 0 0\n0 0 0 0\n0 1 0 0\n1 0 0 0\n"
    "Slice 3 :\n0 0 0 0\n0 0 0 0\n0 1 0 0\n0 0 0 0\n";

TEST(BinaryArray, OfFigure31IsTheThesiss) {
  EXPECT_EQ(text(binary_array(tests::figure_3_1())), binary_array_of_figure);
  EXPECT_TRUE(octree_of(parse_binary_array(universe_of(2), binary_array_of_figure)) == tests::figure_3_1());
}

TEST(BinaryArray, HasEightVoxelsToAByteXFastestAndReadBackIsTheSameTree) {
  tests::for_each_subject([](const tests::Dense& dense, const Octree& octree) {
    const BinaryArray array = binary_array(octree);
    ASSERT_EQ(array.bytes.size(), dense.voxels.size() / 8);
    for (std::size_t i = 0; i < dense.voxels.size(); ++i)
      ASSERT_EQ((array.bytes[i / 8] >> (i % 8)) & 1, dense.voxels[i]) << "voxel " << i;
    ASSERT_TRUE(octree_of(array) == octree);
    ASSERT_EQ(parse_binary_array(octree.universe(), text(array)).bytes, array.bytes);
  });
}

TEST(BinaryArray, IsNotMadeWhereItWouldNotFit) {
  EXPECT_THROW(binary_array(Octree::empty(universe_of(12))), std::length_error);
  EXPECT_THROW(parse_binary_array(universe_of(12), binary_array_of_figure), std::length_error);
  EXPECT_THROW(text(BinaryArray{universe_of(10), {}}), std::length_error);
}

TEST(BinaryArray, ThatIsWrongIsRefusedWithTheCharacter) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string slices = binary_array_of_figure;
    slices.replace(slices.find(from), from.size(), to);
    return refusal([&] { parse_binary_array(universe_of(2), slices); });
  };
  const std::size_t last_digit = binary_array_of_figure.find("1 1 1 0") + 7;
  EXPECT_EQ(with("1 1 1 0", "1 1 1 2"),
            "binary array, character " + std::to_string(last_digit) + ": expected '0', found '2'");
  EXPECT_NE(with("Slice 2", "Slice 3").find("expected 'Slice 2 :'"), std::string::npos);
  EXPECT_NE(refusal([] { parse_binary_array(universe_of(9), "Slice 0 :"); }).find("ends before"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              octree_of(BinaryArray{universe_of(2), {0}});
            }).find("8 bytes, here are 1"),
            std::string::npos);
}

TEST(BinaryArray, MutatedIsRefusedOrAnotherTree) {
  tests::fuzz_text(
      binary_array_of_figure, "binary array", "01 \n",
      [](const std::string& slices) { return octree_of(parse_binary_array(universe_of(2), slices)); },
      [](const Octree& octree) { return text(binary_array(octree)); });
}

}  // namespace
}  // namespace octotomy::voxel
