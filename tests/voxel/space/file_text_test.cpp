// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/file_text.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::voxel {
namespace {

TEST(FileText, APipeIsRefusedAndNotWaitedFor) {
  const tests::ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/zero", folder / "zeros");
  for (const char* name : {"pipe", "zeros"}) {
    try {
      file_bytes(folder / name);
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Input);
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

TEST(FileText, OfAFolderOrAMissingFileThereIsNothingToRead) {
  const tests::ScratchFolder folder;
  EXPECT_EQ(file_bytes(folder.path()), "");
  EXPECT_EQ(file_bytes(folder / "missing"), "");
  tests::write_bytes(folder / "file", "two\nlines");
  EXPECT_EQ(file_bytes(folder / "file"), "two\nlines");
}

}  // namespace
}  // namespace octotomy::voxel
