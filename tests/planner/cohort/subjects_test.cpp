// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/subjects.h"

#include <fstream>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

/// The message of the refusal; empty if there is none.
std::string table_refusal(const std::filesystem::path& table) {
  try {
    find_subjects(table, {});
    return "";
  } catch (const voxel::Error& error) {
    EXPECT_EQ(error.code(), voxel::ErrorCode::Input);
    return error.what();
  }
}

TEST(Subjects, APipeIsNoTableAndIsNotWaitedFor) {
  const tests::ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "scans.csv").c_str(), 0600), 0);
  EXPECT_EQ(table_refusal(folder / "scans.csv"),
            (folder / "scans.csv").string() + ": is a pipe or device: copy it into a file first");
}

TEST(Subjects, ADeviceBehindALinkIsNoTable) {
  const tests::ScratchFolder folder;
  std::filesystem::create_symlink("/dev/zero", folder / "scans.csv");
  EXPECT_EQ(table_refusal(folder / "scans.csv"),
            (folder / "scans.csv").string() + ": is a pipe or device: copy it into a file first");
}

TEST(Subjects, AColumnIsKnownWhateverItsCapitalsAndARowWithoutOneIsShown) {
  const tests::ScratchFolder folder;
  std::ofstream(folder / "scans.csv") << "Participant_ID,Scan\na,a.nrrd\n";
  Plan plan;
  plan.scans["ct"].path = "head.nrrd";
  const std::vector<Subject> subjects = find_subjects(folder / "scans.csv", plan);
  ASSERT_EQ(subjects.size(), 1U);
  EXPECT_EQ(subjects[0].label, "a");
  std::ofstream(folder / "names.csv") << "name,scan\na,a.nrrd\n";
  EXPECT_NE(table_refusal(folder / "names.csv").find("participant_id; its first row is 'name,scan'"),
            std::string::npos);
}

TEST(Subjects, OneScanOfTwoAndColumnsThatNothingReadsAreTold) {
  const tests::ScratchFolder folder;
  const auto doubts = [&](const std::string& table) {
    std::ofstream(folder / "scans.csv") << table;
    Plan plan;
    plan.scans["ct"] = {};
    return doubts_of_cohort(folder / "scans.csv", plan, find_subjects(folder / "scans.csv", plan));
  };
  EXPECT_TRUE(doubts("participant_id,scan\na,a.nrrd\nb,b.nrrd\n").empty());
  const auto shared = doubts("participant_id,scan\na,a.nrrd\nb,./a.nrrd\n");
  ASSERT_EQ(shared.size(), 1U);
  EXPECT_EQ(shared[0].rfind("the subjects a, b have one scan, ", 0), 0U) << shared[0];
  const auto unread = doubts("participant_id,scan,unit\na,a.nrrd,cm\n");
  ASSERT_EQ(unread.size(), 1U);
  EXPECT_NE(unread[0].find("unused columns 'unit'"), std::string::npos) << unread[0];
}

class BidsSubjects : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& text = "") {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  static Plan plan_of(const std::vector<std::string>& scans) {
    Plan plan;
    for (const std::string& scan : scans) plan.scans[scan].path = "head.nrrd";
    return plan;
  }
  std::vector<std::string> labels(const std::filesystem::path& input, const Plan& plan) {
    std::vector<std::string> found;
    for (const Subject& subject : find_subjects(input, plan))
      found.push_back(subject.label + subject.trouble);
    return found;
  }

  tests::ScratchFolder folder_;
};

TEST_F(BidsSubjects, SessionsHideNeitherASubjectsOwnScanNorTheSubjectsLabel) {
  put("sub-01/ct/sub-01_ct.nii.gz");
  put("sub-01/ses-1/ct/sub-01_ses-1_ct.nii.gz");
  put("sub-02/ses-1/ct/sub-02_ses-1_ct.nii.gz");
  put("sub-02/ses-2/ct/sub-02_ses-2_ct.nii.gz");
  const Plan plan = plan_of({"ct"});
  EXPECT_EQ(labels(folder_.path(), plan),
            (std::vector<std::string>{"01", "01_ses-1", "02_ses-1", "02_ses-2"}));
  const auto chosen = chosen_subjects(find_subjects(folder_.path(), plan), {"sub-02"});
  ASSERT_EQ(chosen.size(), 2U);
  EXPECT_EQ(chosen[0].label, "02_ses-1");
  EXPECT_EQ(chosen_subjects(find_subjects(folder_.path(), plan), {"01_ses-1"}).size(), 1U);
  EXPECT_EQ(chosen_subjects(find_subjects(folder_.path(), plan), {"01"}).size(), 1U) << "a whole label";
  EXPECT_THROW(chosen_subjects(find_subjects(folder_.path(), plan), {"0"}), voxel::Error);
}

TEST_F(BidsSubjects, ALabelMapBesideTheOnlyScanIsNoSecondScan) {
  put("sub-01/ct/sub-01_ct.nii.gz");
  put("sub-01/ct/sub-01_dseg.nii.gz");
  put("sub-01/ct/sub-01_desc-bone_mask.nii.gz");
  const std::vector<Subject> found = find_subjects(folder_.path(), plan_of({"head"}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].trouble, "");
  EXPECT_EQ(found[0].scans.at("head").filename(), "sub-01_ct.nii.gz");
  EXPECT_EQ(find_subjects(folder_.path(), plan_of({"ct", "dseg"}))[0].scans.at("dseg").filename(),
            "sub-01_dseg.nii.gz");
}

TEST_F(BidsSubjects, APictureOfMagneticResonanceIsNoCtOfThePlan) {
  for (const char* name : {"anat/sub-01_T1w.nii.gz", "func/sub-01_task-rest_bold.nii.gz"}) {
    put(std::string("sub-01/") + name);
    const Subject subject = find_subjects(folder_.path(), plan_of({"ct"})).at(0);
    EXPECT_NE(subject.trouble.find("no scan"), std::string::npos) << name << subject.trouble;
    std::filesystem::remove(folder_ / "sub-01" / name);
  }
  put("sub-01/anat/sub-01_T1w.nii.gz");
  EXPECT_EQ(find_subjects(folder_.path(), plan_of({"T1w"})).at(0).trouble, "") << "the plan names it";
}

TEST_F(BidsSubjects, AFileOfAnotherSubjectIsTold) {
  put("sub-01/ct/sub-02_ct.nii.gz");
  put("sub-03/ses-1/ct/sub-03_ses-1_ct.nii.gz");
  const std::vector<Subject> found = find_subjects(folder_.path(), plan_of({"ct"}));
  EXPECT_NE(found.at(0).trouble.find("sub-02_ct.nii.gz"), std::string::npos) << found.at(0).trouble;
  EXPECT_EQ(found.at(1).trouble, "");
}

TEST_F(BidsSubjects, ATableOfTabsNamesScansOrTheFoldersBesideIt) {
  put("sub-01/ct/sub-01_ct.nii.gz");
  put("sub-02/ct/sub-02_ct.nii.gz");
  put("sub-03/ct/sub-03_ct.nii.gz");
  put("scans.tsv", "participant_id\tage\tscan\nsub-01\t20\tsub-01/ct/sub-01_ct.nii.gz\n");
  const std::vector<Subject> named = find_subjects(folder_ / "scans.tsv", plan_of({"ct"}));
  ASSERT_EQ(named.size(), 1U);
  EXPECT_TRUE(std::filesystem::exists(named[0].scans.at("ct")));
  put("participants.tsv", "participant_id\tage\nsub-01\t20\nsub-03\tn/a\n");
  EXPECT_EQ(labels(folder_ / "participants.tsv", plan_of({"ct"})), (std::vector<std::string>{"01", "03"}));
}

TEST_F(BidsSubjects, ASubjectThatTheTableListsAndThatHasNoFolderIsTold) {
  put("sub-01/ct/sub-01_ct.nii.gz");
  put("participants.tsv", "participant_id\tage\nsub-01\t20\nsub-07\t31\n");
  for (const std::filesystem::path& input : {folder_.path(), folder_ / "participants.tsv"}) {
    const std::vector<Subject> found = find_subjects(input, plan_of({"ct"}));
    ASSERT_EQ(found.size(), 2U) << input;
    EXPECT_EQ(found[0].trouble, "");
    EXPECT_EQ(found[1].label, "07");
    EXPECT_NE(found[1].trouble.find("lists sub-07"), std::string::npos) << found[1].trouble;
  }
}

TEST_F(BidsSubjects, AFileThatStepsReadIsTheSubjectsOwnByItsName) {
  put("sub-01/ct/sub-01_ct.nii.gz");
  put("sub-01/ct/sub-01_marks.fcsv");
  const Subject subject = find_subjects(folder_.path(), plan_of({"ct"}))[0];
  EXPECT_EQ(file_of_subject(subject, "plans/marks.fcsv").filename(), "sub-01_marks.fcsv");
  EXPECT_TRUE(file_of_subject(subject, "other.fcsv").empty());
  put("sub-01/marks.fcsv");
  EXPECT_THROW(file_of_subject(subject, "marks.fcsv"), voxel::Error);
}

}  // namespace
}  // namespace octotomy::planner
