// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/manipulation_study.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <iterator>
#include <sstream>

namespace octotomy::verify {
namespace {

std::vector<std::uint64_t> numbers(const RepresentationStudy& study, const std::string& item) {
  const auto row = std::find_if(study.beside.begin(), study.beside.end(),
                                [&](const ThesisComparison& one) { return one.item.starts_with(item); });
  EXPECT_NE(row, study.beside.end()) << item;
  if (row == study.beside.end()) return {};
  std::istringstream text(row->ours);
  return {std::istream_iterator<std::uint64_t>(text), {}};
}

/// Full and Empty of level 8, in which nothing is Partial.
std::vector<std::uint64_t> leaves(const RepresentationStudy& study, const std::string& tree) {
  const auto row = std::find_if(study.beside.begin(), study.beside.end(), [&](const ThesisComparison& one) {
    return one.item.starts_with(tree + "level 8");
  });
  if (row == study.beside.end()) return {};
  std::istringstream text(row->ours.substr(2));
  return {std::istream_iterator<std::uint64_t>(text), {}};
}

TEST(ManipulationStudy, OperationsInOneWalkMakeTheTreesOfOperationsOneByOne) {
  const RepresentationStudy study = manipulation_study();
  ASSERT_EQ(study.entries.size(), 4u);
  for (const ThesisEntry& entry : study.entries)
    EXPECT_EQ(entry.ours, entry.printed) << entry.where << ", " << entry.item;
  // The sphere's two parts add up to it, within its digitisation, and a motion by whole voxels keeps them.
  const auto voxels = numbers(study, "intersection, difference, translation, union");
  ASSERT_EQ(voxels.size(), 4u);
  EXPECT_NEAR(static_cast<double>(voxels[0] + voxels[1]) / (4.0 / 3.0 * M_PI * 64 * 64 * 64), 1.0, 0.002);
  EXPECT_EQ(voxels[2], voxels[0]);
  EXPECT_LT(voxels[3], voxels[0] + voxels[1]);
  EXPECT_GT(voxels[3], voxels[1]);
  // Every Partial node of level 7 has eight children at level 8, none of which is Partial.
  for (const char* tree :
       {"A, ", "B, ", "A n B, ", "A - B, ", "intersection, ", "difference, translated, "}) {
    const auto above = numbers(study, std::string(tree) + "level 7"), finest = leaves(study, tree);
    ASSERT_EQ(above.size(), 3u);
    ASSERT_EQ(finest.size(), 2u);
    EXPECT_GT(above[0], 1000u) << tree;
    EXPECT_EQ(8 * above[0], finest[0] + finest[1]) << tree;
  }
}

TEST(ManipulationStudy, TheTreesOfTables73And77AreRecomputedAtEveryLevelAndThePrintedOnesAddUp) {
  const RepresentationStudy study = manipulation_study();
  int trees = 0, misprints = 0;
  std::uint64_t above = 1;
  for (const ThesisComparison& one : study.beside) {
    const auto level = one.item.find(", level ");
    if (level == std::string::npos) continue;
    if (one.item.find("level 1,") != std::string::npos) {
      ++trees;
      above = 1;
    }
    std::istringstream text(one.printed);
    std::string partial, full, empty;
    text >> partial >> full >> empty;
    const auto number = [](const std::string& word) { return word == "-" ? 0 : std::stoull(word); };
    misprints += 8 * above != number(partial) + number(full) + number(empty) ? 1 : 0;
    above = number(partial);
  }
  EXPECT_EQ(trees, 8);
  // "2,366" for 2,336 in A, "25,558" for 22,558 in the last tree, and "1,098" for 10,981 in A - B, which two
  // levels show.
  EXPECT_EQ(misprints, 4);
}

}  // namespace
}  // namespace octotomy::verify
