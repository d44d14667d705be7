// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/run_length.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

using tests::refusal;
using tests::universe_of;

const std::string runs_of_figure = "8:9 12:13 23:26 28:29 41:41 44:44 57:57";

Octree decoded_runs(int depth, const std::string& runs) {
  return octree_of(parse_run_length(universe_of(depth), runs));
}

TEST(RunLength, OfFigure31IsTheThesiss) {
  EXPECT_EQ(text(run_length(tests::figure_3_1())), runs_of_figure);
  EXPECT_TRUE(decoded_runs(2, runs_of_figure) == tests::figure_3_1());
}

TEST(RunLength, HoldsTheRunsOfAPlainArrayAndReadBackIsTheSameTree) {
  tests::for_each_subject([](const tests::Dense& dense, const Octree& octree) {
    std::vector<octotomy::voxel::Run> expected;
    for (std::size_t i = 0; i < dense.voxels.size(); ++i) {
      if (dense.voxels[i] == 0) continue;
      if (i > 0 && dense.voxels[i - 1] != 0)
        expected.back().last = i;
      else
        expected.push_back({i, i});
    }
    const RunLength code = run_length(octree);
    ASSERT_EQ(code.runs, expected);
    ASSERT_TRUE(octree_of(code) == octree);
    ASSERT_EQ(parse_run_length(octree.universe(), text(code)).runs, code.runs);
  });
}

TEST(RunLength, CountsBeyond32BitsInTheLargestUniverse) {
  for (const Octree& octree : tests::sparse_subjects())
    EXPECT_TRUE(decoded_runs(12, text(run_length(octree))) == octree);
  EXPECT_EQ(text(run_length(decoded_runs(12, "68719476735:68719476735"))), "68719476735:68719476735");
}

TEST(RunLength, ThatIsWrongIsRefusedWithTheRunOrTheCharacter) {
  const auto of = [](const std::string& runs) { return refusal([&] { decoded_runs(2, runs); }); };
  EXPECT_EQ(of("8;9"), "run length, character 2: expected ':', found ';'");
  EXPECT_EQ(of("8:9 x"), "run length, character 5: expected a number, found 'x'");
  EXPECT_EQ(of("8:9,12:13"), "run length, character 4: expected a space, found ','");
  EXPECT_EQ(of("9:8"), "run length, run 1, 9:8: ends before it begins");
  EXPECT_EQ(of("8:9 9:12"), "run length, run 2, 9:12: does not come after its predecessor");
  EXPECT_EQ(of("8:9 10:12"), "run length, run 2, 10:12: continues its predecessor: merge the two runs");
  EXPECT_EQ(of("8:64"), "run length, run 1, 8:64: leaves the universe of 64 voxels");
  EXPECT_NE(of("8:99999999999999999999").find("character 3: a number of at most"), std::string::npos);
  EXPECT_NE(of("0:18446744073709551615").find("leaves the universe"), std::string::npos);
}

TEST(RunLength, MutatedIsRefusedOrAnotherTree) {
  tests::fuzz_text(
      runs_of_figure, "run length",
      "0123456789: ", [](const std::string& runs) { return decoded_runs(2, runs); },
      [](const Octree& octree) { return text(run_length(octree)); });
}

}  // namespace
}  // namespace octotomy::voxel
