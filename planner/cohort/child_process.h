// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <csignal>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace octotomy::planner {

/// A pipe. Child programs do not inherit its ends, except for an end that is passed as
/// ChildProcess::inherited_file.
class Pipe {
 public:
  /// Throws std::system_error if the system can make no further pipe.
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
  std::vector<std::string> words;             ///< the program, which is searched in PATH, and its arguments
  std::vector<std::string> environment = {};  ///< "NAME=value", added to this process's environment or
                                              ///< replacing it
  std::optional<int> inherited_file = {};     ///< a descriptor that the child inherits under the same number
  /// The signal that the child receives when this process ends for any reason, even by SIGKILL. Processes
  /// that the child has started do not receive it.
  int signal_at_our_end = SIGTERM;
};

struct ChildEnd {
  int status = 0;    ///< as waitpid() reports it
  std::string said;  ///< the first line that it wrote to standard output
};

/// Runs a program and waits for its end. The program uses this process's standard input and error. If a stop
/// is requested, sends SIGTERM to the program, waits for its end and throws Stopped. Throws voxel::Error
/// (Resource) if the program cannot be started.
ChildEnd run_child_process(const ChildProcess& child, const std::stop_token& stop);

}  // namespace octotomy::planner
