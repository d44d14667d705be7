// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <csignal>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A pipe that child programs do not inherit, unless one of its ends is passed to them.
class Pipe {
 public:
  /// Throws std::system_error if the system has none left.
  Pipe();
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe();

  int reading() const { return reading_; }
  int writing() const { return writing_; }
  void close_writing();

 private:
  int reading_ = -1, writing_ = -1;
};

struct ChildProcess {
  std::vector<std::string> words;             ///< the program, found by PATH, and its arguments
  std::vector<std::string> environment = {};  ///< "NAME=value", added to this process's environment or
                                              ///< replacing it
  std::optional<int> inherited_file = {};     ///< a descriptor that keeps its number in the child
  /// Sent to the child when this process ends, even by SIGKILL. Does not reach processes started by the
  /// child.
  int signal_at_our_end = SIGTERM;
};

struct ChildEnd {
  int status = 0;    ///< as waitpid() reports it
  std::string said;  ///< the first line of its standard output
};

/// Runs a program to its end; it shares this process's standard input and error. A stop is passed on as
/// SIGTERM; then waits for the end and throws Stopped. Throws voxel::Error (Resource) if the program cannot
/// be started.
ChildEnd run_child_process(const ChildProcess& child, const std::stop_token& stop);

}  // namespace octotomy::planner
