// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/result_folder.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"
#include "voxel/space/error.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

int entries(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(ResultFolder, IsNotThereBeforeItIsWhole) {
  const tests::ScratchFolder folder;
  {
    ResultFolder result(folder / "out");
    voxel::write_file(result.path() / "result.json", "{}");
    EXPECT_FALSE(fs::exists(folder / "out"));
    result.publish();
  }
  EXPECT_TRUE(fs::exists(folder / "out/result.json"));
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(ResultFolder, LeavesNothingWhereItIsNotFinished) {
  const tests::ScratchFolder folder;
  {
    const ResultFolder result(folder / "out");
    voxel::write_file(result.path() / "result.json", "{}");
  }
  EXPECT_EQ(entries(folder.path()), 0);
}

/// Publishes a result of these files, each with `text`.
void publish(const fs::path& folder, const std::vector<fs::path>& names, const std::string& text) {
  ResultFolder result(folder);
  for (const fs::path& name : names) {
    fs::create_directories((result.path() / name).parent_path());
    voxel::write_file(result.path() / name, text);
  }
  result.publish();
}

/// The message of the refusal; empty if there is none.
std::string refusal(const fs::path& folder, const std::vector<fs::path>& names = {}) {
  try {
    need_result_folder(folder, names);
  } catch (const voxel::Error& error) {
    EXPECT_EQ(error.code(), voxel::ErrorCode::Input);
    return error.what();
  }
  EXPECT_NO_THROW(ResultFolder{folder});
  return "";
}

TEST(ResultFolder, ReplacesAnEarlierResultWholly) {
  const tests::ScratchFolder folder;
  publish(folder / "out", {"result.json", "left_over.stl", "views/left.png"}, "old");
  {
    ResultFolder result((folder / "out").string() + "/");
    voxel::write_file(result.path() / "result.json", "new");
    EXPECT_TRUE(fs::exists(folder / "out/left_over.stl"));
    result.publish();
  }
  EXPECT_EQ(tests::bytes_of(folder / "out/result.json"), "new");
  EXPECT_EQ(entries(folder / "out"), 2);  // and its list
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(ResultFolder, FilesOfSomebodyElseStayWhereTheyAre) {
  const tests::ScratchFolder folder;
  publish(folder / "out", {"face.inp", "views/left.png"}, "old");
  voxel::write_file(folder / "out/face.frd", "solved");
  voxel::write_file(folder / "out/views/mine.png", "mine");
  voxel::write_file(folder / "my.plan.json", "plan");
  fs::create_directories(folder / "out/notes/empty");
  voxel::write_file(folder / "out/notes/day.txt", "dear");
  fs::create_symlink("../my.plan.json", folder / "out/plan");
  fs::permissions(folder / "out/notes/day.txt", fs::perms::owner_read);
  publish(folder / "out", {"face.inp"}, "new");
  EXPECT_EQ(tests::bytes_of(folder / "out/face.inp"), "new");
  EXPECT_EQ(tests::bytes_of(folder / "out/face.frd"), "solved");
  EXPECT_EQ(tests::bytes_of(folder / "out/views/mine.png"), "mine");
  EXPECT_FALSE(fs::exists(folder / "out/views/left.png"));
  EXPECT_EQ(tests::bytes_of(folder / "out/notes/day.txt"), "dear");
  EXPECT_EQ(fs::status(folder / "out/notes/day.txt").permissions(), fs::perms::owner_read);
  EXPECT_TRUE(fs::is_directory(folder / "out/notes/empty"));
  EXPECT_EQ(tests::bytes_of(folder / "out/plan"), "plan");
  EXPECT_EQ(entries(folder.path()), 2);
  // And they are still nobody's but the user's: a third result keeps them, too.
  publish(folder / "out", {"face.inp"}, "third");
  EXPECT_EQ(tests::bytes_of(folder / "out/face.frd"), "solved");
}

/// Publishes `text` early; what takes it back.
std::unique_ptr<voxel::Undo> publish_early(const fs::path& folder, const std::string& text) {
  ResultFolder result(folder);
  fs::create_directory(result.path() / "views");
  voxel::write_file(result.path() / "report.html", text);
  voxel::write_file(result.path() / "views/left.png", text);
  return result.publish_early();
}

TEST(ResultFolder, AnEarlyResultIsTakenBackWithNothingOfSomebodyElse) {
  const tests::ScratchFolder folder;
  {
    const auto early = publish_early(folder / "out", "early");
    EXPECT_EQ(tests::bytes_of(folder / "out/views/left.png"), "early");
    EXPECT_EQ(refusal(folder / "out"), "") << "it is a result as any other";
  }
  EXPECT_EQ(entries(folder.path()), 0);
  {
    const auto early = publish_early(folder / "out", "early");
    voxel::write_file(folder / "out/report.html", "mine");
    voxel::write_file(folder / "out/views/mine.png", "mine");
  }
  EXPECT_EQ(tests::bytes_of(folder / "out/report.html"), "mine");
  EXPECT_EQ(tests::bytes_of(folder / "out/views/mine.png"), "mine");
  EXPECT_EQ(entries(folder / "out") + entries(folder / "out/views"), 3);
  fs::create_directory(folder / "empty");
  { const auto early = publish_early(folder / "empty", "early"); }
  EXPECT_TRUE(fs::is_directory(folder / "empty")) << "it was there before";
  EXPECT_EQ(entries(folder / "empty"), 0);
}

TEST(ResultFolder, AnEarlyResultYieldsToAWholeOne) {
  const tests::ScratchFolder folder;
  {
    const auto early = publish_early(folder / "out", "early");
    publish(folder / "out", {"report.html", "views/left.png"}, "whole");
  }
  EXPECT_EQ(tests::bytes_of(folder / "out/report.html"), "whole");
  EXPECT_EQ(tests::bytes_of(folder / "out/views/left.png"), "whole");
  EXPECT_EQ(publish_early(folder / "out", "next"), nullptr) << "an earlier result stands there";
  EXPECT_EQ(tests::bytes_of(folder / "out/report.html"), "whole");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(ResultFolder, AChangedFileIsRefusedByItsName) {
  const tests::ScratchFolder folder;
  publish(folder / "out", {"report.html", "views/left.png"}, "old");
  EXPECT_EQ(refusal(folder / "out"), "");
  voxel::write_file(folder / "out/views/left.png", "odl");
  EXPECT_NE(refusal(folder / "out").find("out/views/left.png: was changed"), std::string::npos);
  fs::remove(folder / "out/views/left.png");
  EXPECT_EQ(refusal(folder / "out"), "");
  fs::create_directory(folder / "out/views/left.png");
  EXPECT_NE(refusal(folder / "out").find("left.png: was changed"), std::string::npos);
}

TEST(ResultFolder, AFileInTheWayIsRefusedBeforeTheWork) {
  const tests::ScratchFolder folder;
  publish(folder / "out", {"report.html"}, "old");
  voxel::write_file(folder / "out/face.inp", "mine");
  voxel::write_file(folder / "out/views", "mine");
  EXPECT_EQ(refusal(folder / "out", {"report.html", "other.inp"}), "");
  EXPECT_NE(refusal(folder / "out", {"./face.inp"}).find("out/face.inp: is not"), std::string::npos);
  EXPECT_NE(refusal(folder / "out", {"views/left.png"}).find("out/views: is not"), std::string::npos);
  EXPECT_EQ(tests::bytes_of(folder / "out/face.inp"), "mine");
}

TEST(ResultFolder, AFileThatChangesDuringTheWorkIsKeptAndSoIsTheResult) {
  for (const char* touched : {"report.html", "face.inp", "face.inp/mine"})
    for (const bool while_written : {false, true}) {
      const tests::ScratchFolder folder;
      publish(folder / "out", {"report.html"}, "old");
      const auto touch = [&] {
        fs::create_directories((folder / "out" / touched).parent_path());
        voxel::write_file(folder / "out" / touched, "mine");
      };
      if (!while_written) touch();
      ResultFolder result(folder / "out");
      voxel::write_file(result.path() / "report.html", "new");
      voxel::write_file(result.path() / "face.inp", "new");
      if (while_written) touch();
      try {
        result.publish();
        FAIL() << touched << " was overwritten";
      } catch (const voxel::Error& error) {
        EXPECT_NE(std::string(error.what()).find((folder / "out.new").string()), std::string::npos);
      }
      EXPECT_EQ(tests::bytes_of(folder / "out" / touched), "mine");
      EXPECT_EQ(tests::bytes_of(folder / "out.new/report.html"), "new");
      EXPECT_EQ(entries(folder.path()), 2);
    }
}

TEST(ResultFolder, AFileThatComesToStandInItsPlaceIsKeptAndSoIsTheResult) {
  const tests::ScratchFolder folder;
  voxel::write_file(folder / "out", "mine");
  try {
    publish(folder / "out", {"report.html"}, "new");
    FAIL() << "the file was replaced";
  } catch (const voxel::Error& error) {
    EXPECT_NE(std::string(error.what()).find((folder / "out.new").string()), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(tests::bytes_of(folder / "out"), "mine");
  EXPECT_EQ(tests::bytes_of(folder / "out.new/report.html"), "new");
}

TEST(ResultFolder, RefusesAFolderOfSomethingElseAndAFile) {
  const tests::ScratchFolder folder;
  fs::create_directories(folder / "thesis");
  voxel::write_file(folder / "thesis/chapter_1.tex", "dear");
  voxel::write_file(folder / "thesis/result.json", "{}");
  EXPECT_NE(refusal(folder / "thesis").find("no list of an earlier result"), std::string::npos);
  EXPECT_NE(refusal(folder / "thesis/chapter_1.tex").find("is a file"), std::string::npos);
  EXPECT_NE(refusal(folder / "thesis/chapter_1.tex/out").find("is a file"), std::string::npos);
  EXPECT_NE(refusal("/proc").find("mounted"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "thesis/chapter_1.tex"));
  fs::create_directories(folder / "empty");
  EXPECT_EQ(refusal(folder / "empty"), "");
  EXPECT_EQ(refusal(folder / "not/there/yet"), "");
}

TEST(ResultFolder, ItsListTellsWhichFilesAreAResultsAndWhereOneMayBePut) {
  const tests::ScratchFolder folder;
  publish(folder / "out", {"report.html", "views/left.png"}, "old");
  voxel::write_file(folder / "out/views/mine.png", "mine");
  voxel::write_file(folder / "mine.png", "mine");
  fs::create_directory_symlink("out", folder / "link");
  for (const char* name :
       {"out/report.html", "out/views/left.png", "out/views/../report.html", "link/report.html"})
    EXPECT_TRUE(is_of_result(folder / name)) << name;
  for (const char* name : {"out", "out/views/mine.png", "mine.png", "out/not_there"})
    EXPECT_FALSE(is_of_result(folder / name)) << name;
  fs::create_directories(folder / "empty");
  for (const char* name : {"out", "link", "empty", "not/there"})
    EXPECT_TRUE(may_hold_result(folder / name)) << name;
  for (const char* name : {"out/views", "mine.png"}) EXPECT_FALSE(may_hold_result(folder / name)) << name;
}

TEST(ResultFolder, TheWorkingFolderIsNotReplacedUnderItsShell) {
  const tests::ScratchFolder folder;
  const fs::path before = fs::current_path();
  fs::create_directories(folder / "out/below");
  fs::current_path(folder / "out/below");
  for (const char* name : {".", "..", "../", "../../out"})
    EXPECT_NE(refusal(name).find("working folder"), std::string::npos) << name;
  EXPECT_EQ(refusal("../beside"), "");
  EXPECT_EQ(refusal("report"), "");
  fs::current_path(before);
}

TEST(ResultFolder, ALinkIsFollowedAndPermissionsStay) {
  const tests::ScratchFolder folder;
  fs::create_directories(folder / "disk");
  fs::create_directory_symlink("disk/out/", folder / "link");
  publish(folder / "link", {"report.html"}, "old");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(tests::bytes_of(folder / "disk/out/report.html"), "old");
  fs::permissions(folder / "disk/out", fs::perms::owner_all);
  fs::permissions(folder / "disk/out/report.html", fs::perms::owner_read | fs::perms::owner_write);
  publish(folder / "link/", {"report.html"}, "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(tests::bytes_of(folder / "disk/out/report.html"), "new");
  EXPECT_EQ(fs::status(folder / "disk/out").permissions(), fs::perms::owner_all);
  EXPECT_EQ(fs::status(folder / "disk/out/report.html").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  fs::remove(folder / "link");
  fs::create_directory_symlink("link", folder / "link");
  EXPECT_NE(refusal(folder / "link").find("link"), std::string::npos);
}

TEST(ResultFolder, ALinkIsReadFromTheFolderThatItLiesIn) {
  const tests::ScratchFolder folder;
  fs::create_directories(folder / "home");
  fs::create_directories(folder / "disk/deep");
  publish(folder / "home/target", {"report.html"}, "of another plan");
  fs::create_directory_symlink("../disk/deep", folder / "home/link");
  fs::create_directory_symlink("../target", folder / "disk/deep/report");
  publish(folder / "home/link/report", {"report.html"}, "new");
  EXPECT_EQ(tests::bytes_of(folder / "home/target/report.html"), "of another plan");
  EXPECT_EQ(tests::bytes_of(folder / "disk/target/report.html"), "new");
  publish(folder / "home/link/../beside", {"report.html"}, "new");
  EXPECT_TRUE(fs::exists(folder / "disk/beside/report.html"));
  EXPECT_FALSE(fs::exists(folder / "home/beside"));
}

TEST(ResultFolder, ANameThatATerminalWouldObeyIsRefused) {
  const tests::ScratchFolder folder;
  EXPECT_NE(refusal(folder / "re\nport").find("control characters"), std::string::npos);
}

/// Runs `work` in a process that is killed after a while; false if it had failed before.
template <typename Work>
bool killed_after(std::chrono::microseconds while_us, const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      work();
    } catch (...) {
      ::_exit(1);
    }
  }
  std::this_thread::sleep_for(while_us);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

TEST(ResultFolder, AKillAtAnyInstantLeavesAWholeResultAndEveryFileOfSomebodyElse) {
  const tests::ScratchFolder folder;
  const fs::path out = folder / "out";
  const std::vector<fs::path> names{"report.html", "result.json", "views/a.png", "views/b.png"};
  publish(out, names, "0");
  voxel::write_file(out / "mine.frd", "mine");
  voxel::write_file(out / "views/mine.png", "mine");
  std::mt19937 random(1);
  int round = 0, killed = 0;
  std::set<std::string> seen;
  // A child that was killed before it published shows nothing new: the next ones get more time.
  int longest_us = 12000;
  while (round < 60 || (seen.size() <= 10 && round < 600)) {
    ++round;
    const std::chrono::microseconds while_us(std::uniform_int_distribution<int>(500, longest_us)(random));
    killed += killed_after(while_us, [&] {
      for (int i = 0;; ++i) publish(out, names, std::to_string(round) + "." + std::to_string(i));
    });
    const std::string text = tests::bytes_of(out / "report.html");
    if (!seen.insert(text).second) longest_us = std::min(longest_us + longest_us / 10, 2000000);
    for (const fs::path& name : names) ASSERT_EQ(tests::bytes_of(out / name), text) << name << " " << round;
    ASSERT_EQ(tests::bytes_of(out / "mine.frd"), "mine") << round;
    ASSERT_EQ(tests::bytes_of(out / "views/mine.png"), "mine") << round;
    ASSERT_EQ(entries(out), 5) << round;
    ASSERT_EQ(refusal(out, names), "") << round;
    ASSERT_EQ(entries(folder.path()), 1) << "leftovers are removed by the next run";
  }
  EXPECT_EQ(killed, round);
  EXPECT_GT(seen.size(), 10u) << "the children published next to nothing";
}

}  // namespace
}  // namespace octotomy::planner
