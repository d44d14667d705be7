// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A fork and an exec instead of voxel::spawn(), which cannot ask for a signal at the end of the parent
// (PR_SET_PDEATHSIG). The system sends that signal when the thread that forked ends. The same thread waits for the
// child, so it ends before the child only if the whole process ends.
#include "planner/cohort/child_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "voxel/space/error.h"
#include "voxel/space/spawn.h"

extern char** environ;  // NOLINT(readability-redundant-declaration)

namespace octotomy::planner {
namespace {

using Words = std::vector<std::string>;

/// The variables of this process's environment, each as "NAME=value"; those in `added` are added or take the
/// place of others.
Words environment_with(const Words& added) {
  Words all = added;
  for (char** each = environ; *each != nullptr; ++each) {
    const std::string word = *each;
    const std::string name = word.substr(0, word.find('=') + 1);
    if (std::none_of(added.begin(), added.end(),
                     [&](const std::string& other) { return other.starts_with(name); }))
      all.push_back(word);
  }
  return all;
}

/// Pointers to the words, followed by a null pointer, as exec() requires. The words must outlive them.
std::vector<char*> pointers_to(Words& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Data of the forked process. They are prepared before the fork, because afterwards that process must not
/// allocate memory: another thread's lock would never be released.
struct ReadyProgram {
  Words words, environment;
  std::vector<char*> arguments = pointers_to(words), variables = pointers_to(environment);
  int inherited_file = -1;
  int signal_at_parents_end = SIGTERM;
  pid_t parent = getpid();
};

/// Replaces the forked process by the program. If that fails, writes the system's error number to `failure`
/// and ends the process.
[[noreturn]] void become(const ReadyProgram& program, int output, int failure) {
  // The parent's handler would treat a signal before exec() as a request to the parent.
  std::signal(program.signal_at_parents_end, SIG_DFL);
  prctl(PR_SET_PDEATHSIG, program.signal_at_parents_end);
  // If the parent ended before prctl(), no signal will arrive.
  if (getppid() != program.parent) _exit(0);
  dup2(output, STDOUT_FILENO);
  if (program.inherited_file >= 0) fcntl(program.inherited_file, F_SETFD, 0);
  execvpe(program.arguments[0], program.arguments.data(), program.variables.data());
  const int reason = errno;
  [[maybe_unused]] const ssize_t told = write(failure, &reason, sizeof reason);
  _exit(0);
}

/// Starts the program with `output` as its standard output. Returns its process id. Throws voxel::Error
/// (Resource) if the program cannot be started.
pid_t started(const ChildProcess& child, int output) {
  const ReadyProgram program{.words = child.words,
                             .environment = environment_with(child.environment),
                             .inherited_file = child.inherited_file.value_or(-1),
                             .signal_at_parents_end = child.signal_at_our_end};
  Pipe failure;
  const pid_t process = fork();
  if (process == 0) become(program, output, failure.writing());
  if (process < 0) throw std::system_error(errno, std::generic_category(), "fork");
  failure.close_writing();
  int reason = 0;
  if (read(failure.reading(), &reason, sizeof reason) != sizeof reason) return process;
  waitpid(process, nullptr, 0);
  throw voxel::Error(voxel::ErrorCode::Resource,
                     child.words[0] + " cannot be started: " + std::generic_category().message(reason) +
                         (reason == ENOENT ? "; install it, or choose another --engine" : ""));
}

}  // namespace

Pipe::Pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  reading_ = ends[0];
  writing_ = ends[1];
}

Pipe::~Pipe() {
  close(reading_);
  close_writing();
}

void Pipe::close_writing() {
  if (writing_ >= 0) close(writing_);
  writing_ = -1;
}

ChildEnd run_child_process(const ChildProcess& child, const std::stop_token& stop) {
  Pipe output;
  const pid_t process = started(child, output.writing());
  output.close_writing();
  std::string said;
  std::thread reader([&] {
    std::array<char, 4096> part{};
    for (ssize_t count = 0; (count = read(output.reading(), part.data(), part.size())) > 0;)
      if (said.size() < 65536) said.append(part.data(), static_cast<std::size_t>(count));
  });
  bool is_asked = false;
  const int status = voxel::wait_for_end(process, std::chrono::milliseconds(10), [&] {
    if (is_asked || !stop.stop_requested()) return;
    is_asked = true;
    kill(process, SIGTERM);
  });
  reader.join();
  if (is_asked) throw voxel::Stopped("stopped: the results of finished subjects stay");
  return {status, said.substr(0, said.find('\n'))};
}

}  // namespace octotomy::planner
