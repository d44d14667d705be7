// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/sha256.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/voxel/scratch_folder.h"

namespace octotomy::planner {
namespace {

class Sha256 : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  tests::ScratchFolder folder_;
};

TEST_F(Sha256, IsThatOfTheStandardsExamples) {
  // FIPS 180-4's published examples.
  EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST_F(Sha256, OfAFileIsThatOfItsBytesAlsoBeyondOneBuffer) {
  const std::string bytes(3'000'000, 'x');
  write("a", bytes);
  EXPECT_EQ(sha256_of_path(folder_ / "a"), sha256_of(bytes));
}

TEST_F(Sha256, OfAPatternIsThatOfAFolderWithTheImagesAlone) {
  write("a1.png", "one");
  write("a2.png", "two");
  write("a.txt", "none of the pattern's");
  const std::string zero(1, '\0');
  const std::string lines = "a1.png" + zero + sha256_of("one") + "\na2.png" + zero + sha256_of("two") + "\n";
  EXPECT_EQ(sha256_of_path(folder_ / "a*.png"), sha256_of(lines));
  EXPECT_THROW(sha256_of_path(folder_ / "b*.png"), std::runtime_error);
}

TEST_F(Sha256, OfAFolderIsTheSumOfItsSortedNamesAndSums) {
  write("b", "two");
  write("a", "one");
  const std::string zero(1, '\0');
  const std::string lines = "a" + zero + sha256_of("one") + "\nb" + zero + sha256_of("two") + "\n";
  EXPECT_EQ(sha256_of_path(folder_.path()), sha256_of(lines));
}

TEST_F(Sha256, OfAFolderChangesWithOneRenamedFile) {
  write("a", "one");
  const std::string before = sha256_of_path(folder_.path());
  std::filesystem::rename(folder_ / "a", folder_ / "b");
  EXPECT_NE(sha256_of_path(folder_.path()), before);
}

TEST_F(Sha256, NamesTheFileThatIsNotThere) {
  try {
    sha256_of_path(folder_ / "missing");
    FAIL() << "a missing file has a sum";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("missing"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace octotomy::planner
