// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/disk_need.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/error.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

/// A disk of one MiB; where none can be mounted there is none.
class SmallDisk {
 public:
  explicit SmallDisk(fs::path folder) : folder_(std::move(folder)) {
    fs::create_directory(folder_);
    is_there_ = ::mount("none", folder_.c_str(), "tmpfs", 0, "size=1m") == 0;
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (is_there_) ::umount(folder_.c_str());
  }
  bool is_there() const { return is_there_; }
  fs::path operator/(const char* name) const { return folder_ / name; }

 private:
  fs::path folder_;
  bool is_there_ = false;
};

std::string refusal(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Resource);
    return error.what();
  }
  return {};
}

Scene scene_of(int side) {
  Scene scene;
  scene.lattice = axis_aligned_lattice(glm::ivec3(side), glm::dvec3(1.0), glm::dvec3(0.0));
  scene.samples = Int16Samples(scene.lattice.sample_count(), 0);
  return scene;
}

TEST(NeedDisk, RefusesWithBothFiguresWhatDoesNotFitAndNothingThatDoes) {
  const tests::ScratchFolder scratch;
  const SmallDisk disk(scratch / "disk");
  if (!disk.is_there()) GTEST_SKIP() << "a small disk needs the right to mount one";
  const auto free = free_disk(disk / "");
  ASSERT_TRUE(free);
  EXPECT_GT(*free, 900000u);
  EXPECT_LE(*free, 1u << 20);
  EXPECT_EQ(refusal([&] { need_disk(disk / "fits.raw", *free); }), "");
  const std::string told = refusal([&] { need_disk(disk / "larger.raw", *free + 1); });
  EXPECT_NE(told.find("larger.raw: writing it takes at least 1.05 MB of disk, 1.05 MB are free"),
            std::string::npos)
      << told;
  // What fits is written to the last byte, and a byte more is refused.
  std::ofstream(disk / "fits.raw") << std::string(*free, 'x');
  EXPECT_EQ(fs::file_size(disk / "fits.raw"), *free);
  EXPECT_NE(refusal([&] { need_disk(disk / "more.raw", 1); }), "");
}

TEST(NeedDisk, LooksBehindLinksAndAboveFoldersThatAreNotThereYet) {
  const tests::ScratchFolder scratch;
  const SmallDisk disk(scratch / "disk");
  if (!disk.is_there()) GTEST_SKIP() << "a small disk needs the right to mount one";
  fs::create_symlink(disk / "scan.nii", scratch / "link.nii");
  EXPECT_NE(refusal([&] { need_disk(scratch / "link.nii", 2 << 20); }), "");
  EXPECT_NE(refusal([&] { need_disk(disk / "a/b/c", 2 << 20); }), "");
  EXPECT_EQ(refusal([&] { need_disk(scratch / "plain.nii", 2 << 20); }), "");
}

TEST(NeedDisk, WritersAskBeforeTheirFirstByte) {
  const tests::ScratchFolder scratch;
  const SmallDisk disk(scratch / "disk");
  if (!disk.is_there()) GTEST_SKIP() << "a small disk needs the right to mount one";
  const Scene small = scene_of(32), large = scene_of(100);  // 2 MB
  EXPECT_NE(refusal([&] { write_scene(large, disk / "large.nii"); }).find("at least 2 MB"),
            std::string::npos);
  EXPECT_NE(refusal([&] { write_dicom_series(large, disk / "large"); }).find("at least 2 MB"),
            std::string::npos);
  for (const char* name : {"large.nrrd", "large.nii.gz"})
    EXPECT_EQ(refusal([&] { write_scene(large, disk / name); }), "") << "zeros are packed";
  EXPECT_EQ(refusal([&] { write_scene(small, disk / "small.nii"); }), "");
}

TEST(LeastFileBytes, IsNoMoreThanWhatIsWritten) {
  const tests::ScratchFolder scratch;
  const Scene zeros = scene_of(64);
  for (const char* name : {"a.nrrd", "a.mha", "a.nii", "a.nhdr"}) {
    write_scene(zeros, scratch / name);
    std::uintmax_t bytes = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(scratch / "")) {
      bytes += entry.file_size();
      fs::remove(entry.path());
    }
    EXPECT_LE(least_file_bytes(zeros.lattice, 2, name), bytes) << name;
    EXPECT_GT(least_file_bytes(zeros.lattice, 2, name), 0u) << name;
  }
}

}  // namespace
}  // namespace octotomy::voxel
