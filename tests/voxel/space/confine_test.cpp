// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/confine.h"

#include <csignal>
#include <fcntl.h>
#include <functional>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tests/voxel/scratch_folder.h"

namespace octotomy::voxel {
namespace {

/// The number with which a child process ends that is confined to a folder and then calls this; -1: it was killed.
int in_confinement(const std::filesystem::path& folder, const std::function<int()>& act) {
  const pid_t child = fork();
  if (child == 0) _exit(confine(folder) ? act() : 99);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool creates(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_CREAT | O_WRONLY, 0600);
  if (file >= 0) close(file);
  return file >= 0;
}

class Confine : public testing::Test {
 protected:
  void SetUp() override {
#ifdef OCTOTOMY_SANITIZED
    GTEST_SKIP() << "a sanitizer's runtime calls what a confined process may not";
#endif
    if (in_confinement(folder_ / "", [] { return 0; }) == 99)
      GTEST_SKIP() << "this kernel has no Landlock or no seccomp";
  }

  tests::ScratchFolder folder_;
};

TEST_F(Confine, ThreadsMemoryAndReadingStay) {
  EXPECT_EQ(in_confinement(folder_ / "",
                           [] {
                             int value = 0;
                             std::thread([&] { value = 7; }).join();
                             const std::vector<char> memory(std::size_t{1} << 24, 'a');
                             const int file = open("/proc/self/status", O_RDONLY);
                             return file >= 0 && memory.back() == 'a' ? value : 1;
                           }),
            7);
}

TEST_F(Confine, NoProgramProcessOrSocketIsMade) {
  EXPECT_EQ(in_confinement(folder_ / "",
                           [] { return socket(AF_INET, SOCK_STREAM, 0) < 0 && errno == EPERM ? 7 : 1; }),
            7);
  EXPECT_EQ(in_confinement(folder_ / "", [] { return fork() < 0 ? 7 : 1; }), 7);
  EXPECT_EQ(in_confinement(folder_ / "",
                           [] {
                             execl("/bin/true", "true", nullptr);
                             return errno == EPERM ? 7 : 1;
                           }),
            7);
  EXPECT_EQ(in_confinement(folder_ / "", [] { return kill(getppid(), 0) < 0 && errno == EPERM ? 7 : 1; }), 7);
}

TEST_F(Confine, FilesAreChangedInTheFolderAlone) {
  std::filesystem::create_directory(folder_ / "own");
  const auto own = folder_ / "own/a", other = folder_ / "b";
  EXPECT_EQ(in_confinement(folder_ / "own", [&] { return creates(own) && unlink(own.c_str()) == 0 ? 7 : 1; }),
            7);
  EXPECT_EQ(in_confinement(folder_ / "own", [&] { return creates(other) ? 1 : 7; }), 7);
  ASSERT_TRUE(creates(other));
  EXPECT_EQ(in_confinement(folder_ / "own", [&] { return unlink(other.c_str()) == 0 ? 1 : 7; }), 7);
  EXPECT_EQ(in_confinement(folder_ / "own", [&] { return rmdir((folder_ / "own").c_str()) == 0 ? 7 : 1; }),
            7);
}

}  // namespace
}  // namespace octotomy::voxel
