// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/subjects.h"

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

}  // namespace
}  // namespace octotomy::planner
