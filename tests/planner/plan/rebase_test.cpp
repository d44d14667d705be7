// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/rebase.h"

#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/merge.h"

namespace octotomy::planner {
namespace {

constexpr const char* rebased_plan = R"({"octotomy_plan": 1, "name": "p",
    "scans": {"ct": {"path": "scans/a.nrrd"}, "far": {"path": "/data/b.nrrd"}},
    "steps": [
      {"id": "skull", "do": "window", "scan": "ct", "low": 300},
      {"id": "plate", "do": "import", "path": "../plates/p.stl"},
      {"id": "piece", "do": "export", "object": "skull", "path": "scans/a.stl"}]})";

TEST(Rebase, PathsThatAreReadNameTheSameFilesAndThoseThatAreWrittenStay) {
  const Plan there = rebased(parse_plan(rebased_plan, "/tmp/one/plans"), "/tmp/two");
  EXPECT_EQ(scan_path(there, there.scans.at("ct")).lexically_normal(), "/tmp/one/plans/scans/a.nrrd");
  const Json json = Json::parse(there.text);
  EXPECT_EQ(json["scans"]["ct"]["path"], "../one/plans/scans/a.nrrd");
  EXPECT_EQ(json["scans"]["far"]["path"], "/data/b.nrrd");
  EXPECT_EQ(json["steps"][1]["path"], "../one/plates/p.stl");
  EXPECT_EQ(json["steps"][2]["path"], "scans/a.stl");
  const Json back = Json::parse(rebased(there, "/tmp/one/plans").text);
  EXPECT_EQ(back, Json::parse(rebased_plan)) << "there and back";
}

TEST(Rebase, APlanOfTheSameFolderKeepsItsBytes) {
  EXPECT_EQ(rebased(parse_plan(rebased_plan, "/tmp/one"), "/tmp/two/../one").text, rebased_plan);
}

TEST(Rebase, PlansOfTwoFoldersThatNameOneScanMergeWithoutAConflict) {
  const Plan base = parse_plan(rebased_plan, "/tmp/one");
  Json changed = Json::parse(rebased(base, "/tmp/two/deep").text);
  changed["steps"][0]["low"] = 250;
  const Plan mine = parse_plan(changed.dump(), "/tmp/two/deep");
  const Merged as_they_are = merge(base, base, mine);
  EXPECT_NE(Json::parse(as_they_are.text)["scans"]["ct"]["path"], "scans/a.nrrd")
      << "unless rebased, the merged plan would look for the scan in the wrong folder";
  const Json merged = Json::parse(merge(base, base, rebased(mine, "/tmp/one")).text);
  EXPECT_EQ(merged["scans"]["ct"]["path"], "scans/a.nrrd");
  EXPECT_EQ(merged["steps"][0]["low"], 250);
}

}  // namespace
}  // namespace octotomy::planner
