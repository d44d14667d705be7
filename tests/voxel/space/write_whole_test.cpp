// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/write_whole.h"

#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

/// The code of the error that writing ends with, and its text.
std::pair<ErrorCode, std::string> refusal(void (*write)(const fs::path&, const std::string&),
                                          const fs::path& path) {
  try {
    write(path, std::string(100'000, 'x'));
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  throw std::logic_error(path.string() + " was written");
}

TEST(WriteWhole, ReplacesTheBytesAndLeavesNothingElse) {
  const tests::ScratchFolder folder;
  const std::string bytes("two\nlines\0and a zero", 20);
  write_whole(folder / "file", "old, and longer than what replaces it");
  write_whole(folder / "file", bytes);
  EXPECT_EQ(tests::bytes_of(folder / "file"), bytes);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteWhole, AFullDiskIsNoFaultOfTheInput) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  const auto [code, text] = refusal(write_file, "/dev/full");
  EXPECT_EQ(code, ErrorCode::Resource);
  EXPECT_NE(text.find("/dev/full: cannot be written: No space left on device; make room"), std::string::npos)
      << text;
}

TEST(WriteWhole, AMissingFolderIsNamed) {
  const tests::ScratchFolder folder;
  for (const auto write : {write_file, write_whole}) {
    const auto [code, text] = refusal(write, folder / "away" / "file");
    EXPECT_EQ(code, ErrorCode::Input);
    EXPECT_NE(text.find((folder / "away").string()), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace octotomy::voxel
