// SPDX-License-Identifier: AGPL-3.0-or-later
//
// posix_spawn() instead of fork() and exec: our process has threads, and a forked child could wait for ever
// on a lock that another thread held. Nor does posix_spawn() copy the page tables, which takes long in a
// large process.
#include "voxel/space/spawn.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

namespace octotomy::voxel {
namespace {

/// The file descriptors that a started process opens, duplicates and closes.
class FileActions {
 public:
  explicit FileActions(const Spawn& program) {
    posix_spawn_file_actions_init(&actions_);
    const std::array<std::pair<std::optional<int>, int>, 3> streams{
        {{program.in, STDIN_FILENO}, {program.out, STDOUT_FILENO}, {program.errors, STDERR_FILENO}}};
    for (const auto& [file, stream] : streams) {
      if (file)
        posix_spawn_file_actions_adddup2(&actions_, *file, stream);
      else
        posix_spawn_file_actions_addopen(&actions_, stream, "/dev/null", O_RDWR, 0);
    }
    posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
  }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

/// The signal settings and the process group of a started process.
class Attributes {
 public:
  explicit Attributes(const Spawn& program) {
    posix_spawnattr_init(&attributes_);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    sigdelset(&all, SIGHUP);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    posix_spawnattr_setpgroup(&attributes_, 0);
    const int group = program.has_own_group ? POSIX_SPAWN_SETPGROUP : 0;
    posix_spawnattr_setflags(&attributes_,
                             static_cast<short>(POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | group));
  }
  ~Attributes() { posix_spawnattr_destroy(&attributes_); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
  const posix_spawnattr_t* get() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

}  // namespace

pid_t spawn(const Spawn& program) {
  std::vector<std::string> words = program.words;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  char* no_environment[] = {nullptr};
  const FileActions files(program);
  const Attributes attributes(program);
  pid_t process = -1;
  const int error = posix_spawnp(&process, arguments[0], files.get(), attributes.get(), arguments.data(),
                                 program.has_environment ? environ : no_environment);
  if (error != 0) throw std::system_error(error, std::generic_category(), words[0] + " cannot be started");
  return process;
}

int wait_for_end(pid_t child, std::chrono::milliseconds look_every, const std::function<void()>& look) {
  for (int status = 0;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
    look();
    std::this_thread::sleep_for(look_every);
  }
}

}  // namespace octotomy::voxel
