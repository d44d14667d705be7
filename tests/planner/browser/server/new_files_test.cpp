// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/new_files.h"

#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

/// The names in a folder, hidden ones too.
std::vector<std::string> all_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(NewFiles, TheirFolderIsMadeOnceTheyAreWhole) {
  const tests::ScratchFolder scratch;
  const fs::path folder = scratch / "plan files/series";
  {
    NewFiles files(folder);
    std::ofstream(files.hidden() / "a.node") << "nodes";
    std::ofstream(files.hidden() / "a.ele") << "elements";
    fs::create_directory(files.hidden() / "views");
    EXPECT_FALSE(fs::exists(scratch / "plan files"));
    files.commit("a.node");
  }
  EXPECT_EQ(all_in(folder), (std::vector<std::string>{"a.ele", "a.node", "views"}));
  EXPECT_EQ(tests::bytes_of(folder / "a.ele"), "elements");
  EXPECT_EQ(all_in(scratch.path()), std::vector<std::string>{"plan files"});
}

TEST(NewFiles, WorkThatEndsBeforeLeavesNothing) {
  const tests::ScratchFolder scratch;
  {
    const NewFiles files(scratch / "uploads");
    std::ofstream(files.hidden() / "half.nrrd") << "half";
  }
  EXPECT_TRUE(fs::is_empty(scratch.path()));
}

TEST(NewFiles, OneWhoseNameIsTakenReplacesNothingAndMovesNoOther) {
  const tests::ScratchFolder scratch;
  NewFiles files(scratch.path());
  std::ofstream(files.hidden() / "a.txt") << "new";
  std::ofstream(files.hidden() / "b.txt") << "new";
  std::ofstream(scratch / "b.txt") << "old";
  EXPECT_THROW(files.commit("b.txt"), voxel::Error);
  EXPECT_EQ(tests::bytes_of(scratch / "b.txt"), "old");
  EXPECT_FALSE(fs::exists(scratch / "a.txt"));
}

}  // namespace
}  // namespace octotomy::planner::serve
