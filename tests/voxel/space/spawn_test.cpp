// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/spawn.h"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::voxel {
namespace {

using std::chrono::milliseconds;

/// The exit status of a line of shell, started as `program` says otherwise.
int shell(const std::string& line, Spawn program = {}) {
  program.words = {"sh", "-c", line};
  const int status = wait_for_end(spawn(program), milliseconds(1), [] {});
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Spawn, GivesTheStreamsThatAreNamedAndNoOther) {
  const tests::ScratchFolder folder;
  tests::write_bytes(folder / "in", "question");
  const int in = ::open((folder / "in").c_str(), O_RDONLY | O_CLOEXEC);
  const int out = ::open((folder / "out").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GT(in, 2);
  EXPECT_EQ(shell("cat; echo lost >&2", {.in = in, .out = out}), 0);
  EXPECT_EQ(tests::bytes_of(folder / "out"), "question");
  // Not even a file that is not closed by an exec.
  const int open = ::fcntl(out, F_DUPFD, 20);
  EXPECT_EQ(shell("test -e /proc/self/fd/" + std::to_string(open)), 1);
  for (const int file : {in, out, open}) ::close(file);
}

TEST(Spawn, PassesTheEnvironmentOrNone) {
  ::setenv("OCTOTOMY_SPAWN_TEST", "here", 1);
  EXPECT_EQ(shell("test \"$OCTOTOMY_SPAWN_TEST\" = here"), 0);
  EXPECT_EQ(shell("test -z \"$OCTOTOMY_SPAWN_TEST\"", {.has_environment = false}), 0);
  ::unsetenv("OCTOTOMY_SPAWN_TEST");
}

TEST(Spawn, StartsWithoutBlockedSignals) {
  sigset_t mask, before;
  sigemptyset(&mask);
  sigaddset(&mask, SIGTERM);
  ::pthread_sigmask(SIG_BLOCK, &mask, &before);
  const int status = wait_for_end(spawn({.words = {"sh", "-c", "kill $$; exit 5"}}), milliseconds(1), [] {});
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGTERM);
}

TEST(Spawn, ALookMayEndTheWholeGroup) {
  const pid_t child = spawn({.words = {"sh", "-c", "sleep 100 & wait"}, .has_own_group = true});
  int looks = 0;
  const int status = wait_for_end(child, milliseconds(1), [&] {
    if (++looks == 20) ::kill(-child, SIGKILL);
  });
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_GE(looks, 20);
}

TEST(Spawn, NamesAProgramThatIsNotThere) {
  try {
    spawn({.words = {"/nowhere/program"}});
    FAIL() << "it was started";
  } catch (const std::system_error& error) {
    EXPECT_EQ(error.code().value(), ENOENT);
    EXPECT_NE(std::string(error.what()).find("/nowhere/program cannot be started"), std::string::npos);
  }
  EXPECT_THROW(wait_for_end(::getpid(), milliseconds(1), [] {}), std::system_error) << "no child of ours";
}

}  // namespace
}  // namespace octotomy::voxel
