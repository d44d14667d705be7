// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/helper_file.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

TEST(HelperFile, IsTakenFromTheChosenFolderUnlessOthersMayWriteThere) {
  const tests::ScratchFolder folder;
  set_helper_folder(folder.path());
  EXPECT_THROW(helper_file("helper"), Error);
  std::ofstream(folder / "helper") << "#!";
  EXPECT_EQ(helper_file("helper"), folder / "helper");
  fs::permissions(folder / "helper", fs::perms::others_write, fs::perm_options::add);
  EXPECT_THROW(helper_file("helper"), Error);
  fs::permissions(folder / "helper", fs::perms::others_write, fs::perm_options::remove);
  fs::permissions(folder.path(), fs::perms::others_write, fs::perm_options::add);
  EXPECT_THROW(helper_file("helper"), Error);
  set_helper_folder({});
}

}  // namespace
}  // namespace octotomy::voxel
