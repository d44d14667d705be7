// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result_folder.h"

#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

int entries(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(ResultFolder, IsNotThereBeforeItIsWhole) {
  const tests::TestFolder folder;
  {
    ResultFolder result(folder / "out");
    write_text(result.path() / "result.json", "{}");
    EXPECT_FALSE(fs::exists(folder / "out"));
    result.publish();
  }
  EXPECT_TRUE(fs::exists(folder / "out/result.json"));
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(ResultFolder, LeavesNothingWhereItIsNotFinished) {
  const tests::TestFolder folder;
  {
    const ResultFolder result(folder / "out");
    write_text(result.path() / "result.json", "{}");
  }
  EXPECT_EQ(entries(folder.path()), 0);
}

TEST(ResultFolder, ReplacesAnEarlierResultWholly) {
  const tests::TestFolder folder;
  fs::create_directories(folder / "out");
  write_text(folder / "out/result.json", "old");
  write_text(folder / "out/left_over.stl", "old");
  ResultFolder result((folder / "out").string() + "/");
  write_text(result.path() / "result.json", "new");
  EXPECT_TRUE(fs::exists(folder / "out/left_over.stl"));
  result.publish();
  EXPECT_FALSE(fs::exists(folder / "out/left_over.stl"));
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(ResultFolder, RefusesAFolderOfSomethingElseAndAFile) {
  const tests::TestFolder folder;
  fs::create_directories(folder / "thesis");
  write_text(folder / "thesis/chapter_1.tex", "dear");
  EXPECT_THROW(ResultFolder(folder / "thesis"), std::runtime_error);
  EXPECT_THROW(ResultFolder(folder / "thesis/chapter_1.tex"), std::runtime_error);
  EXPECT_TRUE(fs::exists(folder / "thesis/chapter_1.tex"));
  fs::create_directories(folder / "empty");
  EXPECT_NO_THROW(ResultFolder(folder / "empty"));
}

TEST(ResultFolder, AFullDiskIsTheSystemsError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  try {
    write_text("/dev/full", std::string(100000, 'x'));
    FAIL() << "a full disk took it";
  } catch (const fs::filesystem_error& error) {
    EXPECT_EQ(error.code().value(), ENOSPC);
  }
}

}  // namespace
}  // namespace octotomy::planner
