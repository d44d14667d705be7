// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/cohort_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// The message of the refusal; empty if there is none.
std::string cohort_refusal(const fs::path& out) {
  try {
    need_cohort_folder(out, {"{}", {cohort_labels}, {"sub-1"}});
    return "";
  } catch (const voxel::Error& error) {
    EXPECT_EQ(error.code(), voxel::ErrorCode::Input);
    return error.what();
  }
}

void expect_named(const std::string& refusal, const fs::path& path) {
  EXPECT_EQ(refusal.rfind(path.string() + ": ", 0), 0u) << refusal;
}

TEST(CohortFolder, APipeInThePlaceOfAFileIsRefusedAtOnce) {
  for (const std::string name : {"dataset_description.json", "code/octotomy.sha256", "code/plan.plan.json",
                                 "code/subjects.txt", "sub-1"}) {
    const tests::ScratchFolder folder;
    const fs::path out = folder / "out";
    prepare_cohort_folder(out, "{}");
    EXPECT_EQ(cohort_refusal(out), "");
    fs::remove(out / name);
    ASSERT_EQ(::mkfifo((out / name).c_str(), 0600), 0);
    expect_named(cohort_refusal(out), out / name);
  }
}

TEST(CohortFolder, ADeviceInThePlaceOfAFileIsRefusedAtOnce) {
  const tests::ScratchFolder folder;
  fs::create_directory(folder / "out");
  fs::create_symlink("/dev/zero", folder / "out/dataset_description.json");
  expect_named(cohort_refusal(folder / "out"), folder / "out/dataset_description.json");
}

TEST(CohortFolder, AFileInThePlaceOfAFolderIsNamed) {
  for (const std::string name : {"out", "out/code", "out/code/locks"}) {
    const tests::ScratchFolder folder;
    fs::create_directories((folder / name).parent_path());
    tests::write_bytes(folder / name, "mine");
    expect_named(cohort_refusal(folder / "out"), folder / name);
    EXPECT_EQ(tests::bytes_of(folder / name), "mine");
  }
}

TEST(CohortFolder, ALinkToNothingStandsForTheFolderThatItNames) {
  for (const std::string name : {"link", "link/"}) {
    const tests::ScratchFolder folder;
    fs::create_directory_symlink("disk/out", folder / "link");
    EXPECT_EQ(cohort_refusal(folder / name), "");
    EXPECT_FALSE(fs::exists(folder / "disk"));
    prepare_cohort_folder(folder / name, "{}");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_EQ(tests::bytes_of(folder / "disk/out/code/plan.plan.json"), "{}");
  }
}

TEST(CohortFolder, ALinkInItToNothingIsNamed) {
  const tests::ScratchFolder folder;
  fs::create_directory(folder / "out");
  fs::create_directory_symlink("nothing", folder / "out/code");
  expect_named(cohort_refusal(folder / "out"), folder / "out/code");
}

TEST(CohortFolder, ALinkToItselfIsNamed) {
  const tests::ScratchFolder folder;
  fs::create_directory_symlink("link", folder / "link");
  expect_named(cohort_refusal(folder / "link"), folder / "link");
}

TEST(CohortFolder, APlaceThatTakesNoFolderIsRefused) {
  // Not even root makes a folder there.
  expect_named(cohort_refusal("/proc/octotomy/out"), "/proc/octotomy/out");
}

}  // namespace
}  // namespace octotomy::planner
