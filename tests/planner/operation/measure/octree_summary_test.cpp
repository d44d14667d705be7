// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/octree_summary.h"

#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

TEST(OctreeSummary, DoubtsOfAScanSurviveInTheMetadataOfItsOctree) {
  const std::vector<voxel::Finding> audit{{"size", voxel::Verdict::Pass, "a head"},
                                          {"unit", voxel::Verdict::Warn, "mm is assumed"},
                                          {"slices", voxel::Verdict::Fail, "two are missing"}};
  Json answer;
  answer["metadata"] = {{"scan", "head.nrrd"}, {"scan_audit", doubts_of(audit)}};
  const std::vector<std::string> expected{"WARN, the octree's scan head.nrrd: unit: mm is assumed",
                                          "FAIL, the octree's scan head.nrrd: slices: two are missing"};
  EXPECT_EQ(told_doubts(answer), expected);
  EXPECT_EQ(doubts_of(std::vector<voxel::Finding>(50, audit[1])).size(), 32U);
}

TEST(OctreeSummary, MetadataOfOtherProgramsHoldNoDoubts) {
  for (const char* metadata : {"null", "\"text\"", "{}", "{\"scan_audit\": 3}",
                               "{\"scan_audit\": [1, null, {}]}", "{\"scan_audit\": [{\"verdict\": 3}]}"}) {
    Json answer;
    answer["metadata"] = Json::parse(metadata);
    EXPECT_TRUE(told_doubts(answer).empty()) << metadata;
  }
}

}  // namespace
}  // namespace octotomy::planner
