// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/same_patient.h"

#include "tests/planner/cli/program/command_line.h"
#include "tests/voxel/scan/structure_set.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::SortedJson;

/// Two DICOM series of different studies, and structure sets drawn on the first.
class SamePatient : public tests::CommandLine {
 protected:
  SamePatient() {
    voxel::write_dicom_series(tests::ball_scene(12.0, 32), folder_ / "ct");
    voxel::write_dicom_series(tests::ball_scene(9.0, 32), folder_ / "other");
    own_ = voxel::read_scene(folder_ / "ct").identity;
    const voxel::Identity other = voxel::read_scene(folder_ / "other").identity;
    put_set("own.dcm", {own_.patient_id, own_.study_uids.at(0), own_.frame_uids.at(0)});
    put_set("frame.dcm", {own_.patient_id, own_.study_uids.at(0), "1.2.3.4"});
    put_set("patient.dcm", {"SOMEBODY-ELSE", own_.study_uids.at(0), own_.frame_uids.at(0)});
    put_set("study.dcm", {own_.patient_id, "1.2.3.5", own_.frame_uids.at(0)});
    put_set("silent.dcm", {});
    EXPECT_NE(own_.frame_uids, other.frame_uids);
  }
  void put_set(const std::string& name, const tests::StatedIdentity& identity) const {
    std::vector<std::vector<glm::dvec3>> contours;
    for (const double z : {-4.0, -2.0, 0.0, 2.0, 4.0})
      contours.push_back(tests::rectangle({-6, -6}, {6, 6}, z));
    write(name, tests::structure_set({{1, "A", contours}}, identity));
  }
  CommandAnswer mask(const std::string& set, const std::string& more = "--like ct") const {
    std::string like = more;
    return run("mask --json --slices " + at(set) + " --structure A -o " + at("m.octree") + " " + like);
  }
  std::string like(const std::string& scan) const { return "--like " + at(scan); }
  static std::string findings(const CommandAnswer& answer) {
    return SortedJson::parse(answer.out)["findings"].dump();
  }

  voxel::Identity own_;
};

TEST_F(SamePatient, AStructureSetDrawnOnAnotherSeriesIsReportedWithBothSeries) {
  ASSERT_FALSE(own_.series_uid.empty());
  put_set("series.dcm", {own_.patient_id, own_.study_uids.at(0), own_.frame_uids.at(0), own_.series_uid});
  put_set("other_series.dcm", {own_.patient_id, own_.study_uids.at(0), own_.frame_uids.at(0), "1.2.3.6"});
  EXPECT_EQ(findings(mask("series.dcm", like("ct"))).find("WARN: series"), std::string::npos);
  const CommandAnswer answer = mask("other_series.dcm", like("ct"));
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const std::string found = findings(answer);
  EXPECT_NE(found.find("WARN: series: "), std::string::npos) << found;
  EXPECT_NE(found.find("the series 1.2.3.6, and "), std::string::npos) << found;
  EXPECT_NE(found.find("is of the series " + own_.series_uid), std::string::npos) << found;
}

TEST_F(SamePatient, AStructureSetOfAnotherPatientStudyOrFrameIsRefusedWithBothValuesAndTheWayToGoOn) {
  const CommandAnswer same = mask("own.dcm", like("ct"));
  ASSERT_EQ(same.status, 0) << same.errors;
  EXPECT_EQ(findings(same).find("identity"), std::string::npos) << findings(same);
  for (const auto& [set, value] : {std::pair<std::string, std::string>{"frame.dcm", "1.2.3.4"},
                                   {"patient.dcm", "SOMEBODY-ELSE"},
                                   {"study.dcm", "1.2.3.5"}}) {
    const CommandAnswer answer = mask(set, like("ct"));
    expect_refused(answer, value);
    expect_refused(answer, "--other-identity");
    EXPECT_EQ(std::filesystem::exists(folder_ / "m.octree"), true) << "the earlier one stays";
    const CommandAnswer forced = mask(set, like("ct") + " --other-identity");
    ASSERT_EQ(forced.status, 0) << forced.errors;
    EXPECT_NE(findings(forced).find("FAIL: identity"), std::string::npos) << findings(forced);
    EXPECT_NE(findings(forced).find(value), std::string::npos) << findings(forced);
  }
}

TEST_F(SamePatient, WhereASideStatesNothingTheFindingsSaySo) {
  for (const auto& [set, scan] :
       {std::pair<std::string, std::string>{"silent.dcm", "ct"}, {"own.dcm", "ball.nrrd"}}) {
    const CommandAnswer answer = mask(set, like(scan));
    ASSERT_EQ(answer.status, 0) << answer.errors;
    EXPECT_NE(findings(answer).find("could not be checked"), std::string::npos) << findings(answer);
  }
}

TEST_F(SamePatient, APlansMaskIsHeldAgainstThePlansScan) {
  const auto plan = [&](const std::string& set, const std::string& more) {
    write("p.plan.json", R"({ "octotomy_plan": 1, "name": "p", "scans": { "ct": { "path": "ct" } },
      "steps": [ { "id": "m", "do": "mask", "slices": ")" +
                             set + R"(", "structure": "A")" + more +
                             R"( }, { "id": "size", "do": "measure", "object": "m" } ] })");
    return run("run " + at("p.plan.json") + " -o " + at("report") + " --json");
  };
  EXPECT_EQ(plan("own.dcm", "").status, 0);
  const CommandAnswer refused = plan("frame.dcm", "");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.errors.find("1.2.3.4"), std::string::npos) << refused.errors;
  EXPECT_NE(refused.errors.find("other_identity"), std::string::npos) << refused.errors;
  const CommandAnswer forced = plan("frame.dcm", R"(, "other_identity": true)");
  ASSERT_EQ(forced.status, 0) << forced.errors;
  EXPECT_NE(forced.out.find("FAIL: identity"), std::string::npos);
}

TEST_F(SamePatient, ASegmentationBesideAScanIsOfItsPatientOrRefused) {
  for (const std::string scan : {"ct", "other"})
    ASSERT_EQ(run("segment " + at(scan) + " --window 0: -o " + at(scan + ".dcm")).status, 0);
  const auto plan = [&](const std::string& seg, const std::string& more) {
    write("p.plan.json", R"({ "octotomy_plan": 1, "name": "p", "scans": { "ct": { "path": "ct" },
      "seg": { "path": ")" + seg +
                             "\"" + more + R"( } },
      "steps": [ { "id": "bone", "do": "window", "scan": "ct", "low": 0 },
        { "id": "label", "do": "segment", "scan": "seg", "label": 1 },
        { "id": "size", "do": "measure", "object": "label" } ] })");
    return run("run " + at("p.plan.json") + " -o " + at("report") + " --json");
  };
  const CommandAnswer same = plan("ct.dcm", "");
  EXPECT_EQ(same.status, 0) << same.errors;
  const CommandAnswer refused = plan("other.dcm", "");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.errors.find(own_.frame_uids[0]), std::string::npos) << refused.errors;
  const CommandAnswer forced = plan("other.dcm", R"(, "other_identity": true)");
  ASSERT_EQ(forced.status, 0) << forced.errors;
  EXPECT_NE(forced.errors.find("FAIL, identity"), std::string::npos) << forced.errors;
  expect_refused(run("convert " + at("other.dcm") + " --source " + at("ct") + " -o " + at("x.dcm")),
                 "--other-identity");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.dcm"));
  EXPECT_EQ(run("convert " + at("ct.dcm") + " --source " + at("ct") + " -o " + at("x.dcm")).status, 0);
  expect_refused(run("compare " + at("ct.dcm") + " " + at("other.dcm")), "--other-identity");
  const CommandAnswer compared =
      run("compare " + at("ct.dcm") + " " + at("other.dcm") + " --other-identity --json");
  ASSERT_EQ(compared.status, 0) << compared.errors;
  EXPECT_NE(findings(compared).find("FAIL: identity"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
