// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <sys/types.h>
#include <vector>

#include "tests/fuzz/case_report.h"

// The program under test, which runs as a process per case or is loaded once for many, and the limits that it
// must keep.
namespace octotomy::tests {

/// A program and the limits of one case of it.
struct Subject {
  std::filesystem::path program;
  double seconds = 20.0;
  std::size_t address_space_mib = 1536;
  std::size_t resident_mib = 384;
  /// The memory limit of a verb that computes. It depends on the work, such as the triangles of a noisy scan,
  /// and not on the file.
  std::size_t computing_mib = 1024;
  /// The number of cases that a child of the loaded program runs. What a child loads and keeps is paid once
  /// for them.
  unsigned batch = 500;
};

/// The outcome of a case.
struct Outcome {
  int status = -1;  ///< exit status, or minus the signal
  bool timed_out = false;
  std::size_t resident_mib = 0;  ///< in a batch: the most that its child ever held
  std::string out, errors;
};

/// Runs the arguments (without the program's name) in a new process; `folder` receives its output. Throws
/// std::runtime_error if no process can be started.
Outcome run_alone(const Subject& subject, const std::vector<std::string>& arguments,
                  const std::filesystem::path& folder);

/// The reason why an outcome is a fault; empty if it is none. These are no faults: status 0 or 1 with a JSON
/// object on standard output; status 2 with one line on standard error and nothing on standard output; within
/// the limits. If `may_lack` is true, status 3 (time, memory or disk) is a refusal like 2.
std::string fault_of(const Outcome& outcome, const Subject& subject, bool may_lack = false);

/// A program that is loaded once: its cases run one after the other in children forked before main().
class LoadedProgram {
 public:
  /// `folder` must outlive this object and receives the program's output. Throws std::runtime_error if the
  /// program cannot serve.
  LoadedProgram(Subject subject, std::filesystem::path folder);
  ~LoadedProgram();
  LoadedProgram(const LoadedProgram&) = delete;
  LoadedProgram& operator=(const LoadedProgram&) = delete;

  /// Runs one case in a child. A child that does not return from it in time is killed.
  Outcome run(const std::vector<std::string>& arguments);

  struct Judged {
    Outcome outcome;
    std::string fault;  ///< empty where there is none
  };
  /// Runs one case and judges it. A case that seems a fault runs again in a new process, and so does a case
  /// to be checked; that outcome counts. The two must be equal, unless the child lacked time or memory.
  /// `before_each` is called before either run.
  Judged judge(
      const std::vector<std::string>& arguments, bool check, bool may_lack = false,
      const std::function<void()>& before_each = [] {});

 private:
  CaseReport next_report() const;
  void begin_child();

  Subject subject_;
  std::filesystem::path folder_;
  int socket_ = -1;
  pid_t server_ = 0, child_ = 0;
  unsigned run_by_child_ = 0;
};

}  // namespace octotomy::tests
