// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/child_process.h"

#include <gtest/gtest.h>

#include "tests/planner/cohort/orphans.h"
#include "tests/run_command.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

/// A child process that runs a shell script.
ChildProcess shell(const std::string& script) {
  return {.words = {"sh", "-c", script}};
}

/// Whether a child ends after its parent was killed at work.
bool ends_with_its_parent(ChildProcess child) {
  const tests::ScratchFolder folder;
  const tests::Orphans orphans;
  child.words.back() += "; touch " + tests::quoted(folder / "at_work") + "; exec sleep 600";
  const pid_t parent = tests::in_process([&] { run_child_process(child, {}); });
  EXPECT_TRUE(tests::holds_soon([&] { return std::filesystem::exists(folder / "at_work"); }));
  ::kill(parent, SIGKILL);
  return orphans.end_by_themselves();
}

TEST(ChildProcess, EndsWithAParentThatIsKilled) {
  EXPECT_TRUE(ends_with_its_parent(shell("true")));
}

TEST(ChildProcess, EndsThoughItIgnoresSigtermWhereSigkillIsAskedFor) {
  ChildProcess child = shell("trap '' TERM");
  child.signal_at_our_end = SIGKILL;
  EXPECT_TRUE(ends_with_its_parent(child));
}

TEST(ChildProcess, ItsStatusAndFirstLineAreTold) {
  const ChildEnd end = run_child_process(shell("echo first; echo second; exit 3"), {});
  EXPECT_EQ(end.said, "first");
  EXPECT_EQ(WEXITSTATUS(end.status), 3);
}

TEST(ChildProcess, VariablesAreReplacedAndAllOthersStay) {
  ::setenv("OCTOTOMY_TEST_REPLACED", "ours", 1);
  ::setenv("OCTOTOMY_TEST_REPLACED_NOT", "ours", 1);
  ChildProcess child = shell("echo $OCTOTOMY_TEST_REPLACED $OCTOTOMY_TEST_REPLACED_NOT");
  child.environment = {"OCTOTOMY_TEST_REPLACED=its own"};
  EXPECT_EQ(run_child_process(child, {}).said, "its own ours");
}

TEST(ChildProcess, HasOnlyTheFileThatItIsGiven) {
  const Pipe pipe;
  ChildProcess child = shell("test -e /proc/self/fd/" + std::to_string(pipe.reading()));
  EXPECT_NE(run_child_process(child, {}).status, 0);
  child.inherited_file = pipe.reading();
  EXPECT_EQ(run_child_process(child, {}).status, 0);
}

TEST(ChildProcess, AStopIsPassedOnAndItsEndWaitedFor) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(run_child_process({.words = {"sleep", "600"}}, stop.get_token()), voxel::Stopped);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
}

TEST(ChildProcess, AProgramThatIsNotThereIsNamed) {
  try {
    run_child_process({.words = {"octotomy-is-not-there"}}, {});
    FAIL() << "it was started";
  } catch (const voxel::Error& error) {
    EXPECT_EQ(error.code(), voxel::ErrorCode::Resource);
    EXPECT_EQ(std::string(error.what()).rfind("octotomy-is-not-there cannot be started", 0), 0u)
        << error.what();
  }
}

}  // namespace
}  // namespace octotomy::planner
