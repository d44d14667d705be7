// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/group.h"

#include "planner/cohort/result_rows.h"
#include "tests/file_bytes.h"
#include "tests/planner/cohort/ball_cohort.h"

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

}  // namespace
}  // namespace octotomy::planner
