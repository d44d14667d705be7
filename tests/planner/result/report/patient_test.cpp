// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/patient.h"

#include <gtest/gtest.h>

#include "planner/result/report/report_page.h"
#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

voxel::Identity jane() {
  voxel::Identity identity{"A17", "DOE^Jane^Ann", {}, {}};
  identity.id_issuer = "HOSP";
  identity.birth_date = "19700131";
  identity.sex = "F";
  identity.study_date = "20200201";
  return identity;
}

ScanRecord scan_of(const std::string& name, const voxel::Identity& identity) {
  ScanRecord scan;
  scan.name = name;
  scan.identity = identity;
  return scan;
}

TEST(Patient, NamesAndDatesAreWrittenForPeople) {
  const auto json = patient_json(jane());
  EXPECT_EQ(json["name"], "DOE, Jane Ann");
  EXPECT_EQ(json["number"], "A17");
  EXPECT_EQ(json["birth_date"], "1970-01-31");
  EXPECT_EQ(json["study_date"], "2020-02-01");
  EXPECT_EQ(patient_text(jane()),
            "DOE, Jane Ann, number A17, issued by HOSP, born 1970-01-31, female, study of 2020-02-01");
}

TEST(Patient, WhatAScanDoesNotStateIsNull) {
  voxel::Identity identity;
  identity.study_date = "20200201";
  EXPECT_TRUE(patient_json(identity).is_null()) << "a date alone names nobody";
  EXPECT_EQ(patient_text(identity), "");
  identity.patient_id = "A17";
  identity.birth_date = "in 1970";
  const auto json = patient_json(identity);
  EXPECT_TRUE(json["name"].is_null());
  EXPECT_TRUE(json["birth_date"].is_null()) << "a date in no readable form is not shown as one";
  EXPECT_EQ(patient_text(identity), "number A17, study of 2020-02-01");
}

TEST(Patient, ANameInSeveralWritingsIsThatOfTheFirstGroupThatIsFilledIn) {
  voxel::Identity identity;
  identity.patient_name = "=\u5c71\u7530^\u592a\u90ce=";
  EXPECT_EQ(patient_json(identity)["name"], "\u5c71\u7530, \u592a\u90ce");
  identity.patient_name = "^Jane";
  EXPECT_EQ(patient_json(identity)["name"], "Jane");
}

TEST(Patient, EachPatientOfAPlanHasALine) {
  Evaluation evaluation;
  EXPECT_EQ(patient_lines(evaluation).size(), 1U);
  evaluation.scans = {scan_of("ct", jane()), scan_of("later", jane())};
  EXPECT_EQ(patient_lines(evaluation), std::vector<std::string>{patient_text(jane())});
  evaluation.scans.push_back(scan_of("donor", {}));
  EXPECT_EQ(patient_lines(evaluation), (std::vector<std::string>{patient_text(jane()) + " (ct, later)",
                                                                 "not stated by the scan (donor)"}));
}

class PatientReport : public testing::Test {
 protected:
  PatientReport() {
    voxel::write_scene(tests::ball_scene(8.0, 24), folder_ / "ball.nrrd");
    result_.plan = parse_plan(R"({"octotomy_plan": 1, "name": "a", "scans": {"ct": {"path": "ball.nrrd"}},
      "steps": [{"id": "bone", "do": "window", "scan": "ct", "low": 0},
                {"id": "size", "do": "measure", "object": "bone"}]})",
                              folder_.path());
    result_.evaluation = evaluate(result_.plan);
    ScanRecord& scan = result_.evaluation.scans.at(0);
    scan.identity = jane();
    scan.audit.push_back({"patient", voxel::Verdict::Warn, "patient 'A17' and 'B23'"});
    result_.evaluation.objects.change(0).findings.push_back(
        "FAIL: identity: ct and rs.dcm are not of one patient: patient 'A17' and 'C99'");
    write_result(result_, folder_ / "open");
    result_.anonymous = true;
    write_result(result_, folder_ / "hidden");
  }

  std::string file(const std::string& name) const { return tests::bytes_of(folder_ / name); }

  tests::ScratchFolder folder_;
  Result result_;
};

TEST_F(PatientReport, TheReportStatesWhomItIsAbout) {
  EXPECT_NE(file("open/report.html").find(patient_text(jane())), std::string::npos);
  for (const char* name : {"open/result.json", "open/tables/measurements.csv", "open/credibility.html"})
    EXPECT_EQ(file(name).find("DOE, Jane"), std::string::npos) << name;
}

TEST_F(PatientReport, AnAnonymousResultNamesNobodyAnywhere) {
  EXPECT_NE(file("hidden/report.html").find("left out as requested"), std::string::npos);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "hidden")) {
    if (!entry.is_regular_file()) continue;
    const std::string text = tests::bytes_of(entry.path());
    for (const char* personal :
         {"DOE, Jane", "DOE^Jane", "'A17'", "B23", "C99", "1970-01-31", "19700131", "2020-02-01"})
      EXPECT_EQ(text.find(personal), std::string::npos) << entry.path() << " holds " << personal;
  }
}

TEST_F(PatientReport, AReportOfAScanWithoutAPatientSaysSo) {
  result_.anonymous = false;
  EXPECT_NE(report_html(result_).find("not stated by the scan"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
