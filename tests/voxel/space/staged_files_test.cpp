// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/staged_files.h"

#include <atomic>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

void publish(const fs::path& folder, const std::string& name, const std::string& text) {
  StagedFiles staged(folder);
  write(staged.folder() / name, text);
  staged.commit();
}

std::ptrdiff_t entries(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(StagedFiles, AreNotThereBeforeTheyAreCommittedAndLeaveNothing) {
  const tests::ScratchFolder folder;
  {
    const StagedFiles staged(folder.path());
    write(staged.folder() / "a", "new");
    EXPECT_FALSE(fs::exists(folder / "a"));
  }
  EXPECT_EQ(entries(folder.path()), 0);
  publish(folder.path(), "a", "new");
  EXPECT_EQ(tests::bytes_of(folder / "a"), "new");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(StagedFiles, FollowALinkAndKeepPermissions) {
  const tests::ScratchFolder folder;
  fs::create_directory(folder / "away");
  write(folder / "away/target", "old");
  fs::permissions(folder / "away/target", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("away/target", folder / "a");
  publish(folder.path(), "a", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "a"));
  EXPECT_EQ(tests::bytes_of(folder / "away/target"), "new");
  EXPECT_EQ(fs::status(folder / "away/target").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("away/not_yet", folder / "b");
  publish(folder.path(), "b", "new");
  EXPECT_EQ(tests::bytes_of(folder / "away/not_yet"), "new");
  fs::create_symlink("round", folder / "round");
  EXPECT_THROW(publish(folder.path(), "round", "new"), Error);
}

TEST(StagedFiles, FollowALinkToAnotherDisk) {
  struct stat here {
  }, there{};
  const tests::ScratchFolder folder;
  if (::stat("/dev/shm", &there) != 0 || ::stat(folder.path().c_str(), &here) != 0 ||
      here.st_dev == there.st_dev || ::access("/dev/shm", W_OK) != 0)
    GTEST_SKIP() << "no other disk at /dev/shm";
  const fs::path target = "/dev/shm/octotomy-staged-" + std::to_string(::getpid());
  fs::create_symlink(target, folder / "a");
  publish(folder.path(), "a", "new");
  EXPECT_EQ(tests::bytes_of(target), "new");
  EXPECT_TRUE(fs::is_symlink(folder / "a"));
  fs::remove(target);
}

TEST(StagedFiles, ReplaceNeitherPipesNorFolders) {
  const tests::ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  fs::create_directory(folder / "folder");
  write(folder / "other", "old");
  for (const char* name : {"pipe", "folder"}) {
    try {
      StagedFiles staged(folder.path());
      write(staged.folder() / "other", "new");
      write(staged.folder() / name, "new");
      staged.commit();
      FAIL() << name << " was replaced";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Input);
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
    }
    EXPECT_EQ(tests::bytes_of(folder / "other"), "old") << "all are replaced, or none";
  }
  EXPECT_TRUE(fs::is_fifo(folder / "pipe"));
}

/// Writes "new" in place of each file, together.
void publish_all(const std::vector<fs::path>& places) {
  StagedOutputs outputs;
  for (const fs::path& place : places) write(outputs.beside(place), "new");
  outputs.commit();
}

TEST(StagedOutputs, OfSeveralFoldersReplaceAllFilesOrNone) {
  const tests::ScratchFolder folder;
  fs::create_directories(folder / "away/taken");
  for (const char* name : {"a", "away/b"}) write(folder / name, "old");
  EXPECT_THROW(publish_all({folder / "a", folder / "away/b", folder / "away/taken"}), Error);
  for (const char* name : {"a", "away/b"}) EXPECT_EQ(tests::bytes_of(folder / name), "old") << name;
  publish_all({folder / "a", folder / "away/b", folder / "away/c"});
  for (const char* name : {"a", "away/b", "away/c"}) EXPECT_EQ(tests::bytes_of(folder / name), "new") << name;
  EXPECT_EQ(entries(folder.path()), 2);
  EXPECT_EQ(entries(folder / "away"), 3);
}

TEST(StagedOutputs, NamesThatWereGivenAreTakenBackWhereALaterOneFails) {
  const tests::ScratchFolder folder;
  write(folder / "a", "old");
  StagedOutputs outputs;
  write(outputs.beside(folder / "a"), "new");
  write(outputs.beside(folder / "b"), "new");
  // A folder that holds something is not replaced by another one, which the disk says when it is renamed.
  fs::create_directory(outputs.beside(folder / "c"));
  fs::create_directory(folder / "c");
  write(folder / "c/mine", "old");
  EXPECT_THROW(outputs.commit(), Error);
  EXPECT_EQ(tests::bytes_of(folder / "a"), "old");
  EXPECT_FALSE(fs::exists(folder / "b"));
}

TEST(StagedOutputs, WhatLiesNextToAHeaderIsRenamedToo) {
  const tests::ScratchFolder folder;
  {
    StagedOutputs outputs;
    const fs::path header = outputs.beside(folder / "a.nhdr");
    write(header, "header");
    write(header.parent_path() / "a.raw.gz", "samples");
    outputs.commit();
  }
  EXPECT_EQ(tests::bytes_of(folder / "a.raw.gz"), "samples");
  EXPECT_EQ(entries(folder.path()), 2);
}

TEST(StagedOutputs, OneFileIsKnownByEachOfItsNames) {
  const tests::ScratchFolder folder;
  write(folder / "a", "old");
  fs::create_symlink("a", folder / "link");
  fs::create_symlink("not_yet", folder / "open_link");
  fs::create_directory_symlink(".", folder / "here");
  fs::create_hard_link(folder / "a", folder / "hard");
  for (const char* name : {"link", "hard", "./a", "here/a"})
    EXPECT_TRUE(are_one_file(folder / "a", folder / name)) << name;
  EXPECT_TRUE(are_one_file(folder / "open_link", folder / "here/not_yet"));
  EXPECT_FALSE(are_one_file(folder / "a", folder / "b"));
}

TEST(StagedOutputs, WhatFollowsALinkedFolderIsAsTheSystemTakesIt) {
  const tests::ScratchFolder scratch;
  const fs::path folder = fs::canonical(scratch.path());
  fs::create_directories(folder / "elsewhere/deep");
  fs::create_directories(folder / "home/inner");
  fs::create_directory_symlink("../elsewhere/deep", folder / "home/link");
  fs::create_symlink("../new", folder / "elsewhere/deep/to_new");
  EXPECT_TRUE(are_one_file(folder / "home/link/../a", folder / "elsewhere/a"));
  EXPECT_FALSE(are_one_file(folder / "home/link/../a", folder / "home/a"));
  EXPECT_EQ(place_of(folder / "home/link/to_new"), folder / "elsewhere/new");
  EXPECT_EQ(place_of(folder / "home/inner/./../a/"), folder / "home/a");
  EXPECT_EQ(place_of(folder / "home/link/.."), folder / "elsewhere");
  fs::create_directory_symlink("inner/./", folder / "home/ends");
  fs::create_directory_symlink("ends/", folder / "home/twice");
  fs::create_directory_symlink("itself/", folder / "itself");
  EXPECT_EQ(place_of(folder / "home/twice/"), folder / "home/inner");
  EXPECT_THROW(place_of(folder / "itself"), Error);
  EXPECT_EQ(absolute_of(folder / "home/link/./a"), folder / "home/link/a");
  write(folder / "elsewhere/a", "here");
  EXPECT_EQ(absolute_of(folder / "home/link/../a"), folder / "elsewhere/a");
  StagedOutputs outputs;
  write(outputs.beside(folder / "home/link/../b"), "new");
  outputs.commit();
  EXPECT_EQ(tests::bytes_of(folder / "elsewhere/b"), "new");
}

/// Runs `work` in a process of its own that then waits for its end; returns when it has worked.
template <typename Work>
pid_t after_work(const Work& work) {
  int ready[2];
  EXPECT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    work([&] {
      EXPECT_EQ(::write(ready[1], "x", 1), 1);
      for (;;) ::pause();
    });
    ::_exit(0);
  }
  char done = 0;
  EXPECT_EQ(::read(ready[0], &done, 1), 1);
  ::close(ready[0]);
  ::close(ready[1]);
  return child;
}

void kill_now(pid_t child) {
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

TEST(StagedFiles, WhatAKilledProcessLeftIsRemovedAndWhatALivingOneHasIsNot) {
  const tests::ScratchFolder folder;
  const auto stage = [&](const auto& wait) {
    const StagedFiles staged(folder.path());
    write(staged.folder() / "a", "half");
    wait();
  };
  const pid_t living = after_work(stage);
  const pid_t killed = after_work(stage);
  EXPECT_EQ(entries(folder.path()), 2);
  kill_now(killed);
  fs::create_directory(folder / ".octotomy-notice");  // the name, not the rights, of a hidden folder
  publish(folder.path(), "a", "new");
  EXPECT_EQ(entries(folder.path()), 3) << "the file, the living one's folder and somebody's notes";
  kill_now(living);
  publish(folder.path(), "a", "new");
  EXPECT_EQ(entries(folder.path()), 2);
}

TEST(UnfinishedFolder, FoldersInItAreMadeOnlyWhileItIsThere) {
  const tests::ScratchFolder folder;
  create_folders_in(folder.path(), "a/b/c");
  create_folders_in(folder.path(), "a/b/d");
  EXPECT_TRUE(fs::is_directory(folder / "a/b/c"));
  EXPECT_TRUE(fs::is_directory(folder / "a/b/d"));
  EXPECT_THROW(create_folders_in(folder / "gone", "a/b"), fs::filesystem_error);
  EXPECT_FALSE(fs::exists(folder / "gone"));
}

TEST(UnfinishedFolder, AnEndingWithoutDestructorsRemovesAll) {
  const tests::ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    const UnfinishedFolder one(folder.path(), ".octotomy-");
    UnfinishedFolder given(folder.path(), "given-");
    write(one.path() / "a", "half");
    const fs::path kept = given.keep();
    const Undo undo([&kept] { write(kept / "b", "undone"); });
    remove_unfinished();
    ::_exit(fs::exists(one.path()) ? 1 : 0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  ASSERT_EQ(entries(folder.path()), 1) << "what was given away stays";
  EXPECT_TRUE(fs::exists(fs::directory_iterator(folder.path())->path() / "b"));
}

TEST(UnfinishedFolder, AnEndingWhileAFolderIsRemovedLeavesNoneOfIt) {
  const tests::ScratchFolder folder;
  for (int i = 0; i < 10; ++i) {
    const pid_t child = ::fork();
    if (child == 0) {
      auto* one = new UnfinishedFolder(folder.path(), ".octotomy-");
      for (int file = 0; file < 2000; ++file) write(one->path() / std::to_string(file), "half");
      std::atomic<bool> has_begun{false};
      std::thread removal([&] {
        has_begun = true;
        delete one;
      });
      removal.detach();  // remove_unfinished() never unlocks
      while (!has_begun) std::this_thread::yield();
      remove_unfinished();
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_EQ(status, 0);
    ASSERT_EQ(entries(folder.path()), 0) << "in round " << i;
  }
}

}  // namespace
}  // namespace octotomy::voxel
