// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/folders.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

class FoldersTest : public testing::Test {
 protected:
  FoldersTest() {
    fs::create_directories(root_ / "open/within");
    fs::create_directories(root_ / "open too");
    fs::create_directories(root_ / "shut");
    std::ofstream(root_ / "open/a.nrrd") << "a";
    std::ofstream(root_ / "shut/b.nrrd") << "b";
    fs::create_directory_symlink(root_ / "shut", root_ / "open/link");
    folders_.open(root_ / "open");
  }

  tests::ScratchFolder kept_;
  fs::path root_ = fs::canonical(kept_.path());
  Folders folders_;
};

TEST_F(FoldersTest, PathsWithinAreMadeAbsolute) {
  EXPECT_EQ(folders_.need_within("a.nrrd"), root_ / "open/a.nrrd");
  EXPECT_EQ(folders_.need_within("within/../a.nrrd"), root_ / "open/a.nrrd");
  EXPECT_EQ(folders_.need_within(root_ / "open/not_yet.stl"), root_ / "open/not_yet.stl");
  EXPECT_EQ(folders_.need_within(""), root_ / "open");
}

TEST_F(FoldersTest, NoWayLeadsOut) {
  // "open too" begins as "open" does.
  const fs::path paths[] = {"..",          "../shut/b.nrrd",       "within/../../shut",
                            "link/b.nrrd", root_ / "shut/b.nrrd",  root_ / "open too",
                            "/etc/passwd", root_ / "open/../shut", root_,
                            "/",           std::string("a\0b", 3), std::string(5000, 'x')};
  for (const fs::path& path : paths) EXPECT_THROW(folders_.need_within(path), voxel::Error) << path;
  EXPECT_THROW(Folders().need_within("a"), voxel::Error);
}

TEST_F(FoldersTest, WhatAPlanMayReadIsNotOpenToThePage) {
  folders_.allow_reading(root_ / "shut/b.nrrd");
  EXPECT_EQ(folders_.need_readable(root_ / "shut/b.nrrd"), root_ / "shut/b.nrrd");
  EXPECT_EQ(folders_.need_readable("a.nrrd"), root_ / "open/a.nrrd");
  EXPECT_THROW(folders_.need_readable(root_ / "shut/c.nrrd"), voxel::Error);
  EXPECT_THROW(folders_.need_within(root_ / "shut/b.nrrd"), voxel::Error);
  EXPECT_EQ(folders_.opened(), std::vector{root_ / "open"});
}

TEST_F(FoldersTest, ALinkToNothingIsJudgedByWhatAWriteWouldMake) {
  fs::create_symlink(root_ / "shut/new.json", root_ / "open/out");
  fs::create_symlink("../open/out", root_ / "open/out_twice");
  fs::create_directory_symlink(root_ / "shut/new", root_ / "open/out_folder");
  fs::create_symlink("within/new.json", root_ / "open/in");
  fs::create_symlink("around", root_ / "open/around");
  for (const char* path : {"out", "out_twice", "out_folder/new.json", "around"})
    EXPECT_THROW(folders_.need_within(path), voxel::Error) << path;
  EXPECT_EQ(folders_.need_within("in"), root_ / "open/within/new.json");
  std::ofstream(folders_.need_within("in")) << "{}";
  EXPECT_TRUE(fs::exists(root_ / "open/within/new.json"));
}

TEST_F(FoldersTest, AHeaderNamesSamplesBesideItOrInOpenFoldersOnly) {
  const auto header = [&](const std::string& data) {
    const fs::path path = root_ / "open/h.mhd";
    std::ofstream(path) << "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"
                           "ElementSpacing = 1 1 1\nElementDataFile = "
                        << data << "\n";
    return path;
  };
  std::ofstream(root_ / "open/h.raw") << "12345678";
  std::ofstream(root_ / "shut/h.raw") << "12345678";
  fs::create_symlink(root_ / "shut/h.raw", root_ / "open/linked.raw");
  EXPECT_NO_THROW(need_readable_samples(folders_, header("h.raw")));
  EXPECT_THROW(need_readable_samples(folders_, header((root_ / "shut/h.raw").string())), voxel::Error);
  EXPECT_THROW(need_readable_samples(folders_, header("../shut/h.raw")), voxel::Error);
  EXPECT_THROW(need_readable_samples(folders_, header("linked.raw")), voxel::Error);
  folders_.allow_reading(root_ / "shut/h.raw");
  EXPECT_NO_THROW(need_readable_samples(folders_, header("../shut/h.raw")));
}

TEST_F(FoldersTest, AFileOpensItsFolderAndThatOnce) {
  folders_.open(root_ / "shut/b.nrrd");
  folders_.open(root_ / "open/within");
  EXPECT_EQ(folders_.opened(), (std::vector<fs::path>{root_ / "open", root_ / "shut"}));
  EXPECT_EQ(folders_.need_within("link/b.nrrd"), root_ / "shut/b.nrrd");
}

TEST_F(FoldersTest, UnusedNamesKeepTheirEndings) {
  EXPECT_EQ(unused(root_ / "open/b.nrrd"), root_ / "open/b.nrrd");
  EXPECT_EQ(unused(root_ / "open/a.nrrd"), root_ / "open/a-2.nrrd");
  std::ofstream(root_ / "open/a.plan.json") << "{}";
  std::ofstream(root_ / "open/a-2.plan.json") << "{}";
  EXPECT_EQ(unused(root_ / "open/a.plan.json"), root_ / "open/a-3.plan.json");
  EXPECT_EQ(plain_stem("x/head.nii.gz"), "head");
  EXPECT_EQ(plain_stem("x/series/"), "series");
}

TEST_F(FoldersTest, AnExportTakesANameWhoseFilesAreAllNew) {
  std::ofstream(root_ / "open/p.ele") << "other";
  std::ofstream(root_ / "open/p-2.face") << "other";
  EXPECT_EQ(unused_export(root_ / "open/p.node"), root_ / "open/p-3.node");
  EXPECT_EQ(unused_export(root_ / "open/p.stl"), root_ / "open/p.stl") << "a surface has no other file";
  EXPECT_EQ(unused_export(root_ / "open/a.nrrd"), root_ / "open/a-2.nrrd");
  EXPECT_EQ(unused(root_ / "open/p.node"), root_ / "open/p.node") << "an upload is one file";
}

TEST(PlainName, StaysBelowItsFolder) {
  for (const char* name : {"head.nrrd", "series/0001.dcm", "a b.stl", "h\u00e9ad.nii.gz"})
    EXPECT_EQ(need_plain_name(name), fs::path(name));
  for (const char* name :
       {"", "..", ".", "../a", "a/../b", "/a", "a/", "a/b/c", ".hidden", "a/.b", "a\nb", "a\\b"})
    EXPECT_THROW(need_plain_name(name), voxel::Error) << name;
}

}  // namespace
}  // namespace octotomy::planner::serve
