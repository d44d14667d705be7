// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <sys/types.h>
#include <vector>

#include "tests/fuzz/case_report.h"

// The program under test, run as a process a case or loaded once for many, and what it may not do.
namespace octotomy::tests {

/// A program and the limits of one case of it.
struct Subject {
  std::filesystem::path program;
  double seconds = 20.0;
  std::size_t address_space_mib = 1536;
  std::size_t resident_mib = 384;
  /// The same of a verb that computes: it follows the work, as the triangles of a noisy scan, not the file.
  std::size_t computing_mib = 1024;
  /// Cases that a child of the loaded program runs: what a child loads and keeps is paid once for them.
  unsigned batch = 500;
};

/// How a case ended.
struct Outcome {
  int status = -1;  ///< exit status, or minus the signal
  bool timed_out = false;
  std::size_t resident_mib = 0;  ///< in a batch: the most that its child ever held
  std::string out, errors;
};

/// Runs the arguments (without the program's name) as a process of their own; `folder` gets its output.
/// Throws std::runtime_error where no process can be started.
Outcome run_alone(const Subject& subject, const std::vector<std::string>& arguments,
                  const std::filesystem::path& folder);

/// Why an outcome is a fault; empty where it is none. None is: status 0 or 1 with a JSON object on standard
/// output; status 2 with one line on standard error and nothing on standard output; within the limits. Where
/// `may_lack` is set, status 3 (time, memory or disk) is a refusal like 2.
std::string fault_of(const Outcome& outcome, const Subject& subject, bool may_lack = false);

/// A program that is loaded once: its cases run one after the other in children forked before main().
class LoadedProgram {
 public:
  /// `folder` must outlive it and gets its output. Throws std::runtime_error where the program cannot serve.
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
  /// Runs one case and judges it. A case that seems a fault runs again as a process of its own, and so does a
  /// case to be checked: that outcome counts. The two must be alike, unless the child wanted time or memory.
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
