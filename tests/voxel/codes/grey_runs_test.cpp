// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/grey_runs.h"

#include <gtest/gtest.h>

#include "tests/voxel/code_subjects.h"

namespace octotomy::voxel {
namespace {

TEST(GreyRuns, OfFigure31AreTheThesiss) {
  // The text's fourth to last runs read (0:11), (0:1), (0:2): the middle one is of ones, as its own list of
  // one-runs says.
  const std::string printed =
      "(0:8), (1:2), (0:2), (1:2), (0:9), (1:4), (0:1), (1:2), (0:11), (1:1), (0:2), (1:1), (0:12), (1:1), "
      "(0:6)";
  EXPECT_EQ(text(grey_runs(tests::figure_3_1())), printed);
  EXPECT_EQ(text(parse_grey_runs(printed)), printed);
}

TEST(GreyRuns, OfAnyObjectAreThoseOfItsArrayAndReadBackAreTheSameSamples) {
  tests::for_each_subject([](const tests::Dense& dense, const Octree& octree) {
    const std::vector<std::int16_t> samples(dense.voxels.begin(), dense.voxels.end());
    const GreyRuns runs = grey_runs(samples);
    ASSERT_EQ(grey_runs(octree), runs);
    ASSERT_EQ(samples_of(runs, samples.size()), samples);
    ASSERT_EQ(parse_grey_runs(text(runs)), runs);
  });
}

TEST(GreyRuns, HoldAllValues) {
  const std::vector<std::int16_t> samples{-32768, -32768, 32767, 0, -1};
  EXPECT_EQ(text(grey_runs(samples)), "(-32768:2), (32767:1), (0:1), (-1:1)");
  EXPECT_EQ(samples_of(parse_grey_runs("(-32768:2), (32767:1), (0:1), (-1:1)"), 5), samples);
}

TEST(GreyRuns, ThatAreWrongAreRefusedWithTheRunOrTheCharacter) {
  EXPECT_NE(tests::refusal([] {
              samples_of({{3, 0}}, 9);
            }).find("run 1, (3:0): is empty"),
            std::string::npos);
  EXPECT_NE(tests::refusal([] {
              samples_of({{3, 1}, {3, 2}}, 9);
            }).find("run 2, (3:2): continues"),
            std::string::npos);
  EXPECT_THROW(samples_of({{3, 10}}, 9), std::length_error);
  EXPECT_NE(tests::refusal([] { parse_grey_runs("(3:1) (2:1)"); }).find("character 7"), std::string::npos);
  EXPECT_NE(tests::refusal([] { parse_grey_runs("(40000:1)"); }).find("at most 32767"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::voxel
