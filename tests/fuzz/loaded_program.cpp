// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/fuzz/loaded_program.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <fcntl.h>
#include <poll.h>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

#include "tests/file_bytes.h"
#include "tests/fuzz/case_report.h"

namespace octotomy::tests {
namespace {

namespace fs = std::filesystem;

fs::path out_in(const fs::path& folder) {
  return folder / "stdout.txt";
}
fs::path errors_in(const fs::path& folder) {
  return folder / "stderr.txt";
}

void limit(int resource, rlim_t most) {
  const rlimit both{most, most};
  setrlimit(resource, &both);
}

/// The arguments and paths of a process under test. They are made before the fork, because this process has
/// threads and little is safe after its fork.
struct Start {
  Start(const Subject& subject, std::vector<std::string> after_name, const fs::path& folder)
      : address_space(rlim_t{subject.address_space_mib} << 20),
        program(subject.program.string()),
        out(out_in(folder).string()),
        errors(errors_in(folder).string()),
        arguments(std::move(after_name)),
        words{program.data()} {
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
  }

  [[noreturn]] void become(const char* const* environment) const {
    const int out_file = open(out.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_APPEND, 0600);
    const int error_file = open(errors.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_APPEND, 0600);
    dup2(out_file, STDOUT_FILENO);
    dup2(error_file, STDERR_FILENO);
    limit(RLIMIT_CORE, 0);
#ifndef OCTOTOMY_SANITIZED
    limit(RLIMIT_AS, address_space);
#endif
    execve(program.c_str(), words.data(), const_cast<char* const*>(environment));
    _exit(127);
  }

  rlim_t address_space;
  std::string program, out, errors;
  std::vector<std::string> arguments;
  std::vector<char*> words;
};

/// Waits until a file can be read; false after so many seconds. They are counted in steps and not by a clock,
/// which goes on while all of these processes are stopped.
bool can_read(int file, double seconds) {
  constexpr int step_ms = 50;
  for (double left_ms = 1e3 * seconds; left_ms > 0.0; left_ms -= step_ms) {
    pollfd waited{file, POLLIN, 0};
    if (poll(&waited, 1, step_ms) > 0) return true;
  }
  return false;
}

/// The output without durations and times of day.
std::string without_times(std::string out) {
  for (const auto& [name, end] : {std::pair{"\"timings_ms\"", '}'}, {"\"made_at\"", '\n'}})
    for (std::size_t at = 0; (at = out.find(name, at)) != std::string::npos;)
      out.erase(at, std::min(out.find(end, at), out.size()) - at);
  return out;
}

bool are_alike(const Outcome& a, const Outcome& b) {
  return a.status == b.status && a.errors == b.errors && without_times(a.out) == without_times(b.out);
}

/// Always false for a sanitized program, whose shadow memory cannot be compared.
bool took_more([[maybe_unused]] const Outcome& outcome, [[maybe_unused]] std::size_t most_mib) {
#ifdef OCTOTOMY_SANITIZED
  return false;
#else
  return outcome.resident_mib > most_mib;
#endif
}

std::string text_of(const Outcome& outcome) {
  return (outcome.timed_out ? "no end in time" : "status " + std::to_string(outcome.status)) + ", " +
         std::to_string(outcome.out.size()) + " bytes said, '" + outcome.errors + "'";
}

}  // namespace

Outcome run_alone(const Subject& subject, const std::vector<std::string>& arguments, const fs::path& folder) {
  const Start start(subject, arguments, folder);
  const pid_t process = fork();
  if (process == 0) {
    limit(RLIMIT_CPU, static_cast<rlim_t>(subject.seconds) + 1);
    start.become(environ);
  }
  if (process < 0) throw std::runtime_error("no process can be started");
  Outcome outcome;
  const auto end = static_cast<int>(syscall(SYS_pidfd_open, process, 0));
  outcome.timed_out = !can_read(end, subject.seconds);
  close(end);
  if (outcome.timed_out) kill(process, SIGKILL);
  int status = 0;
  rusage usage{};
  wait4(process, &status, 0, &usage);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  outcome.resident_mib = static_cast<std::size_t>(usage.ru_maxrss) >> 10;
  outcome.out = bytes_of(out_in(folder));
  outcome.errors = bytes_of(errors_in(folder));
  return outcome;
}

std::string fault_of(const Outcome& outcome, const Subject& subject, bool may_lack) {
  if (outcome.timed_out) return "did not end within " + std::to_string(subject.seconds) + " s";
  if (outcome.status < 0) return "ended by signal " + std::to_string(-outcome.status);
  const bool is_refused = outcome.status == 2 || (may_lack && outcome.status == 3);
  // A plan's kernels may disagree about a damaged plan.
  if (outcome.status != 0 && outcome.status != 1 && !is_refused)
    return "status " + std::to_string(outcome.status) + ": " + outcome.errors;
  if (took_more(outcome, may_lack ? subject.computing_mib : subject.resident_mib))
    return "took " + std::to_string(outcome.resident_mib) + " MiB of memory";
  if (!is_refused) return outcome.out.starts_with("{") ? "" : "read, but no JSON was said";
  const auto lines = std::count(outcome.errors.begin(), outcome.errors.end(), '\n');
  if (lines != 1 || !outcome.errors.starts_with("octotomy: "))
    return "refused with " + std::to_string(lines) + " lines instead of one: " + outcome.errors;
  return outcome.out.empty() ? "" : "refused, but said something on standard output";
}

LoadedProgram::LoadedProgram(Subject subject, fs::path folder)
    : subject_(std::move(subject)), folder_(std::move(folder)) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw std::runtime_error("no socket can be made");
  socket_ = ends[0];
  const Start start(subject_, {std::to_string(ends[1])}, folder_);
  const std::string preload = "LD_PRELOAD=" OCTOTOMY_CASE_SERVER;
  std::vector<const char*> environment{preload.c_str()};
  for (char** entry = environ; *entry != nullptr; ++entry) environment.push_back(*entry);
  environment.push_back(nullptr);
  server_ = fork();
  if (server_ < 0) throw std::runtime_error("no process can be started");
  if (server_ == 0) {
    fcntl(ends[1], F_SETFD, 0);
    start.become(environment.data());
  }
  close(ends[1]);
  begin_child();
}

LoadedProgram::~LoadedProgram() {
  close(socket_);
  kill(server_, SIGKILL);  // its child ends with it
  waitpid(server_, nullptr, 0);
}

CaseReport LoadedProgram::next_report() const {
  CaseReport report;
  if (recv(socket_, &report, sizeof report, 0) != sizeof report)
    throw std::runtime_error(subject_.program.string() + ": cannot be loaded to serve cases");
  return report;
}

void LoadedProgram::begin_child() {
  child_ = next_report().child;
  run_by_child_ = 0;
}

Outcome LoadedProgram::run(const std::vector<std::string>& arguments) {
  std::string request(1, ++run_by_child_ < subject_.batch ? more_follow : last_of_child);
  for (const std::string& word : arguments) request.append(word).push_back('\0');
  if (send(socket_, request.data(), request.size(), MSG_NOSIGNAL) < 0)
    throw std::runtime_error(subject_.program.string() + ": does not take a case");
  Outcome outcome;
  outcome.timed_out = !can_read(socket_, subject_.seconds);
  if (outcome.timed_out) kill(child_, SIGKILL);
  CaseReport report = next_report();
  outcome.status = report.status;
  outcome.resident_mib = static_cast<std::size_t>(report.resident_kib) >> 10;
  outcome.out = bytes_of(out_in(folder_));
  outcome.errors = bytes_of(errors_in(folder_));
  // A child's memory may add up over cases, or the child may return exactly when its time ends.
  const bool is_spent = outcome.timed_out || took_more(outcome, subject_.resident_mib);
  // The number of a child that has ended may belong to another process.
  if (is_spent && report.kind != CaseReport::Ended) kill(child_, SIGKILL);
  while (is_spent && report.kind != CaseReport::Ended) report = next_report();
  if (report.kind == CaseReport::Ended) begin_child();
  return outcome;
}

LoadedProgram::Judged LoadedProgram::judge(const std::vector<std::string>& arguments, bool check,
                                           bool may_lack, const std::function<void()>& before_each) {
  before_each();
  const Outcome batched = run(arguments);
  if (!check && fault_of(batched, subject_, may_lack).empty()) return {batched, ""};
  before_each();
  Judged judged{run_alone(subject_, arguments, folder_), ""};
  judged.fault = fault_of(judged.outcome, subject_, may_lack);
  const bool wanted = batched.timed_out || batched.status == 3 || took_more(batched, subject_.resident_mib);
  if (judged.fault.empty() && !wanted && !are_alike(batched, judged.outcome))
    judged.fault = "in a batch " + text_of(batched) + "; alone " + text_of(judged.outcome);
  return judged;
}

}  // namespace octotomy::tests
