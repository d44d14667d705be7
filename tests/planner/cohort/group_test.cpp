// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/group.h"

#include <algorithm>
#include <cstdio>

#include "planner/cohort/result_rows.h"
#include "tests/file_bytes.h"
#include "tests/planner/cohort/ball_cohort.h"
#include "tests/planner/result/report/page_data.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

class CohortGroup : public tests::BallCohort {
 protected:
  CohortGroup() {
    for (const Subject& each : subjects_)
      EXPECT_EQ(run(each).state, SubjectRecord::State::Done) << each.label;
  }

  std::vector<Subject> subjects_{subject("1"), subject("2")};
};

TEST_F(CohortGroup, AnAnswerThatWasChangedIsNamedAndNotMerged) {
  EXPECT_EQ(merge_group(subjects_, out_)["done"], 2);
  tests::write_bytes(out_ / "sub-1/result.json", "no JSON");
  const nlohmann::ordered_json summary = merge_group(subjects_, out_);
  EXPECT_EQ(summary["done"], 1);
  EXPECT_EQ(summary["without_answer"], 1);
  ASSERT_EQ(summary["findings"].size(), 1u);
  EXPECT_EQ(summary["findings"][0].get<std::string>().rfind(
                "1: " + (out_ / "sub-1/result.json").string() + ": is not as Octotomy wrote it", 0),
            0u)
      << summary["findings"];
  const std::vector<ResultRow> rows = parse_long_table(tests::bytes_of(out_ / "group/measurements.csv"));
  EXPECT_FALSE(rows.empty());
  for (const ResultRow& row : rows) EXPECT_EQ(row.subject, "2");
  EXPECT_NE(tests::bytes_of(out_ / "group/subjects.csv").find("1,changed,"), std::string::npos);
}

TEST_F(CohortGroup, AnotherObserversAnswerThatWasChangedIsNamedToo) {
  const fs::path other = folder_ / "other";
  fs::copy(out_, other, fs::copy_options::recursive);
  GroupOptions options;
  options.against = other;
  EXPECT_EQ(merge_group(subjects_, out_, options)["findings"].size(), 0u);
  tests::write_bytes(other / "sub-2/rows.csv", "");
  const nlohmann::ordered_json summary = merge_group(subjects_, out_, options);
  EXPECT_EQ(summary["done"], 2);
  ASSERT_EQ(summary["findings"].size(), 1u);
  EXPECT_NE(summary["findings"][0].get<std::string>().find((other / "sub-2/rows.csv").string()),
            std::string::npos);
}

/// A ball's scan as a DICOM series, of which the last slices are another patient's.
void write_series(const fs::path& folder, int foreign_slices) {
  const voxel::Scene ball = tests::ball_scene(8.0, 24);
  voxel::write_dicom_series(ball, folder);
  if (foreign_slices == 0) return;
  for (int k = 24 - foreign_slices; k < 24; ++k) {
    char name[32];
    std::snprintf(name, sizeof name, "slice_%04d.dcm", k + 1);
    std::string bytes = tests::bytes_of(folder / name);
    const std::string patient_id("\x10\x00\x20\x00LO", 6);
    bytes.replace(bytes.find("OCTOTOMY", bytes.find(patient_id)), 8, "STRANGER");
    tests::write_bytes(folder / name, bytes);
  }
}

/// Balls' scans, one whole and one that lost slices to another patient.
class CohortAudit : public tests::BallCohort {
 protected:
  CohortAudit() {
    write_series(folder_ / "mixed", 4);
    write_series(folder_ / "whole", 0);
  }
  SubjectRecord run_series(const std::string& label, const std::string& series) {
    subjects_.push_back({label, {{"ct", folder_ / series}}});
    return run(subjects_.back());
  }

  std::vector<Subject> subjects_;
};

TEST_F(CohortAudit, ASubjectWithAFailInAScansAuditIsDoubtfulEverywhere) {
  const SubjectRecord mixed = run_series("1", "mixed"), whole = run_series("2", "whole");
  EXPECT_EQ(to_string(mixed.state), "doubtful");
  EXPECT_EQ(to_string(whole.state), "done");
  ASSERT_FALSE(mixed.audit_findings.empty());
  const auto names_patient = [](const std::string& line) { return line.rfind("FAIL, patient: ", 0) == 0; };
  EXPECT_TRUE(std::any_of(mixed.audit_findings.begin(), mixed.audit_findings.end(), names_patient));
  EXPECT_EQ(subject_record(out_, subjects_[0]).audit_findings, mixed.audit_findings);
  EXPECT_TRUE(run(subjects_[0]).was_kept);

  const nlohmann::ordered_json summary = merge_group(subjects_, out_);
  EXPECT_EQ(summary["done"], 1);
  EXPECT_EQ(summary["doubtful"], 1);
  EXPECT_EQ(summary["without_answer"], 0);
  EXPECT_NE(summary["findings"].dump().find("1: FAIL, patient: "), std::string::npos) << summary["findings"];
  ASSERT_EQ(summary["doubtful"], 1);
  for (const auto& measurement : summary["measurements"]) {
    EXPECT_EQ(measurement["doubtful"], nlohmann::ordered_json::array({"1"}));
    EXPECT_EQ(measurement["subjects"], 2);
    EXPECT_EQ(measurement["without_doubtful"]["subjects"], 1);
  }
  bool has_failed = false, has_passed = false;
  for (const ResultRow& row : parse_long_table(tests::bytes_of(out_ / "group/measurements.csv"))) {
    EXPECT_EQ(row.scan_audit == "FAIL", row.subject == "1") << row.subject << " " << row.scan_audit;
    EXPECT_EQ(row.verdict == "FAIL", row.subject == "1") << row.subject << " " << row.verdict;
    (row.subject == "1" ? has_failed : has_passed) = true;
  }
  EXPECT_TRUE(has_failed && has_passed);
  EXPECT_NE(tests::bytes_of(out_ / "group/subjects.csv").find("1,doubtful,"), std::string::npos);
  EXPECT_NE(tests::bytes_of(out_ / "group/wide.csv").find("FAIL"), std::string::npos);
  const Json shown = tests::page_data(tests::bytes_of(out_ / "group/index.html"))["subjects"];
  EXPECT_EQ(shown[0]["label"], "1");
  EXPECT_EQ(shown[0]["is_doubtful"], true);
  EXPECT_NE(shown[0]["audit"].get<std::string>().find("FAIL, patient: "), std::string::npos);
  EXPECT_EQ(shown[1]["is_doubtful"], false);
}

TEST_F(CohortAudit, AGroupWithoutAFailHasNobodyDoubtful) {
  EXPECT_EQ(to_string(run_series("2", "whole").state), "done");
  const nlohmann::ordered_json summary = merge_group(subjects_, out_);
  EXPECT_EQ(summary["done"], 1);
  EXPECT_EQ(summary["doubtful"], 0);
  EXPECT_EQ(summary["findings"].dump().find("FAIL"), std::string::npos) << summary["findings"];
  for (const auto& measurement : summary["measurements"]) {
    EXPECT_TRUE(measurement["doubtful"].empty());
    EXPECT_FALSE(measurement.contains("without_doubtful"));
  }
  for (const Json& subject : tests::page_data(tests::bytes_of(out_ / "group/index.html"))["subjects"])
    EXPECT_EQ(subject["is_doubtful"], false);
}

TEST(ResultRows, NoVerdictIsBetterThanTheAuditsOfTheScans) {
  const auto rows_with = [](const char* audit, const char* certificate) {
    auto result = nlohmann::ordered_json::parse(R"({"octotomy": "0",
        "scans": [{"name": "ct", "audit": [{"check": "a", "verdict": "PASS", "detail": "x"}]}],
        "measurements": [{"id": "size", "object": "bone", "volume_mm3": 1.0}], "certificates": []})");
    result["scans"][0]["audit"].push_back({{"check", "b"}, {"verdict", audit}, {"detail", "y"}});
    if (*certificate != '\0')
      result["certificates"].push_back({{"object", "bone"}, {"verdict", certificate}});
    const std::vector<ResultRow> rows = rows_of(result, "s");
    EXPECT_EQ(rows.size(), 1u);
    EXPECT_EQ(parse_long_table(long_header() + long_line(rows.at(0))).at(0).scan_audit, audit);
    EXPECT_EQ(scan_audits_of(result).findings.size(), std::string(audit) == "PASS" ? 0u : 1u);
    return rows.at(0).verdict;
  };
  EXPECT_EQ(rows_with("PASS", "PASS"), "PASS");
  EXPECT_EQ(rows_with("WARN", "PASS"), "WARN");
  EXPECT_EQ(rows_with("FAIL", "WARN"), "FAIL");
  EXPECT_EQ(rows_with("WARN", "FAIL"), "FAIL");
  EXPECT_EQ(rows_with("PASS", ""), "");
  EXPECT_EQ(rows_with("FAIL", ""), "FAIL");
}

}  // namespace
}  // namespace octotomy::planner
