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
  const auto finest = numbers(study, "intersection: P of level 7");
  ASSERT_EQ(finest.size(), 3u);
  EXPECT_EQ(8 * finest[0], finest[1] + finest[2]);
}

}  // namespace
}  // namespace octotomy::verify
