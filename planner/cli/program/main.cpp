// SPDX-License-Identifier: AGPL-3.0-or-later
// The program: reads the command line, runs the chosen verb and turns exceptions into an exit status: 2 for
// errors that the user can correct, 3 for time, memory and disk, 70 for a mistake in the program.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <tbb/global_control.h>
#include <thread>
#include <unistd.h>

#include "planner/cli/program/verb_groups.h"
#include "planner/cli/program/verbs.h"
#include "planner/cli/suite/suite.h"
#include "planner/cli/verb/manual.h"
#include "planner/cli/verb/progress_line.h"
#include "planner/cli/verb/verb.h"
#include "planner/operation/table/fault.h"
#include "voxel/space/error.h"
#include "voxel/space/memory_need.h"
#include "voxel/space/unfinished_folder.h"
#include "voxel/space/write_failure.h"

namespace {

using octotomy::planner::cli::Program;
namespace cli = octotomy::planner::cli;
using octotomy::planner::Fault;

std::atomic<int> interrupts{0};
std::atomic<bool> is_processor_time_over{false};

/// Installs a handler. A signal that was ignored when the program started remains ignored, as nohup does with
/// SIGHUP.
void heed(int signal, void (*handler)(int)) {
  if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

/// Installs handlers for signals that request an end. A second SIGINT or SIGTERM ends the process at once.
/// SIGHUP counts once, because a closing terminal may send it twice. SIGXCPU, sent at a limit on processor
/// time, acts like --time-limit. SIGQUIT keeps its default action: the process ends with a core file, and the
/// next run removes its unfinished files, as after SIGKILL.
void heed_signals() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { ++interrupts; });
  heed(SIGHUP, [](int) {
    int none = 0;
    interrupts.compare_exchange_strong(none, 1);
  });
  heed(SIGXCPU, [](int) { is_processor_time_over = true; });
  // At a closed pipe or a limit on file size, the failed call already reports the error. The signals are
  // caught instead of ignored, because child programs would inherit ignored signals.
  for (const int signal : {SIGPIPE, SIGXFSZ}) heed(signal, [](int) {});
}

/// Prints the reason and ends the process with status 3, even if the verb's threads still run. Removes their
/// unfinished files. Child processes end with this one.
[[noreturn]] void end_now(const char* why) {
  octotomy::voxel::remove_unfinished();
  cli::end_progress();
  cli::warn(why);
  std::_Exit(cli::out_of_resources);
}

constexpr const char* out_of_memory =
    "out of memory: nothing was written; use larger voxels (universe, voxel_mm), a smaller scan, or raise "
    "--memory";

/// Ends the process at once for lack of memory or threads. Called if an allocation failed, or if a thread had
/// an error that nothing handles, most likely because no further thread could be started. Code that continues
/// without its memory could crash or wait forever.
[[noreturn]] void end_for_want(const char* why) {
  static std::atomic_flag ending;
  if (ending.test_and_set()) ::pause();
  octotomy::voxel::lift_memory_limit();
  end_now(why);
}

/// The handler of std::terminate: reports an exception that no thread has caught, and ends the process.
[[noreturn]] void end_of_no_handler() {
  std::string what = "an error without a handler";
  try {
    if (std::current_exception() == nullptr) throw std::bad_alloc();  // a thread did not start or join
    throw;
  } catch (const std::exception& error) {
    const Fault fault = octotomy::planner::fault_of(error);
    if (fault == Fault::Resource || dynamic_cast<const std::system_error*>(&error) != nullptr)
      end_for_want(
          "out of memory or of threads: nothing was written; use larger voxels, fewer --threads, or raise "
          "--memory");
    what = error.what();
  } catch (...) {
  }
  octotomy::voxel::remove_unfinished();
  cli::end_progress();
  cli::warn(octotomy::planner::message_of(octotomy::planner::InternalError(what)));
  std::_Exit(cli::internal_error);
}

/// Watches the verb from its own thread. Requests the verb to stop when its time is over or the user
/// interrupts, and ends the process if the verb does not stop soon or a second interrupt arrives. Ends with
/// its scope.
class Watch {
 public:
  explicit Watch(Program& program)
      : thread_([&program](const std::stop_token& over) { run(program, over); }) {}

 private:
  using Clock = std::chrono::steady_clock;
  /// Time for the verb to stop and print its own message. Then the process is ended.
  static constexpr std::chrono::milliseconds grace{150};
  static constexpr std::chrono::milliseconds look_every{5};

  static void run(Program& program, const std::stop_token& over) {
    const Clock::time_point start = Clock::now();
    const bool shows = program.shows_progress();
    std::optional<Clock::time_point> asked;
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any end;  // in contrast to a sleep, wakes at once when the verb has ended
    while (!end.wait_for(lock, over, look_every, [&over] { return over.stop_requested(); })) {
      if (octotomy::voxel::is_memory_over()) end_for_want(out_of_memory);
      if (shows) cli::show_silent_work();
      const bool late = is_processor_time_over ||
                        (program.time_limit_s &&
                         std::chrono::duration<double>(Clock::now() - start).count() > *program.time_limit_s);
      if (interrupts > 1) end_now("interrupted twice: ended at once, unfinished files are removed");
      if (!late && interrupts == 0) continue;
      program.stop.request_stop();
      if (!asked) asked = Clock::now();
      if (Clock::now() < *asked + grace) continue;
      // A verb that has begun to print its answer may finish, because the answer is complete. Only an
      // interrupt ends it then: the reader of its output may never read.
      if (has_last_word(cli::Speaker::Watch))
        end_now(interrupts > 0 ? "interrupted: nothing was written" : "out of time: nothing was written");
      if (interrupts > 0) end_now("interrupted while the answer was written");
    }
  }

  std::jthread thread_;
};

/// Prints an error on one line and returns its exit status. Waits forever if the watch already prints how the
/// process ends.
int refuse(const std::string& text, int status) {
  while (!has_last_word(cli::Speaker::Verb)) std::this_thread::sleep_for(std::chrono::seconds(1));
  cli::warn(text);
  return status;
}

/// The exit status for a kind of error.
int status_of(Fault fault) {
  if (fault == Fault::Internal) return cli::internal_error;
  return fault == Fault::Cancelled || fault == Fault::Resource ? cli::out_of_resources : cli::bad_input;
}

/// Prints an error and returns its exit status. The text of an internal error also names the verb, which a
/// report of the error needs. Other texts name a file or an option.
int refuse(const std::exception& error, const std::string& verb) {
  const Fault fault = octotomy::planner::fault_of(error);
  if (fault != Fault::Internal || verb.empty())
    return refuse(octotomy::planner::message_of(error), status_of(fault));
  const octotomy::planner::InternalError named(verb + ", " + error.what());
  return refuse(octotomy::planner::message_of(named), status_of(fault));
}

/// The name of the verb on the command line; empty if there is none.
std::string verb_of(const CLI::App& app) {
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  return verbs.empty() ? "" : verbs.front()->get_name();
}

int run_chosen(Program& program) {
  try {
    std::unique_ptr<tbb::global_control> threads;
    if (program.threads)
      threads = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                      static_cast<std::size_t>(*program.threads));
    if (program.memory_gb) {
      octotomy::voxel::limit_memory(static_cast<std::uint64_t>(std::min(*program.memory_gb, 1e9) * 1e9));
      std::set_new_handler([] { end_for_want(out_of_memory); });
      if (octotomy::voxel::is_memory_over()) end_for_want(out_of_memory);
    }
    const Watch watch(program);
    const cli::FindingsOfRun findings;
    return program.chosen();
  } catch (const std::bad_alloc&) {
    return refuse(out_of_memory, cli::out_of_resources);
  } catch (const std::exception& error) {
    return refuse(error, verb_of(program.app));
  }
}

/// Refuses an empty output path, which can come from an unset variable in a script.
void need_named_outputs(const CLI::App& verb) {
  for (const CLI::Option* option : verb.get_options())
    if (option->check_sname("o") && option->count() > 0 && option->results().back().empty())
      throw CLI::ValidationError("-o", "has no name: give the file or folder to write");
  for (const CLI::App* chosen : verb.get_subcommands()) need_named_outputs(*chosen);
}

/// Prints the help or version to standard output. Fails if that cannot be written, for example to a full
/// disk.
int say_help(const CLI::App& app, const CLI::ParseError& error) {
  app.exit(error);
  std::cout.flush();
  if (std::cout && std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return cli::done;
  return refuse(std::system_error(errno, std::generic_category(), "standard output"), "");
}

int parse_and_run(int count, char** arguments) {
  CLI::App app(
      "Plans an operation on a skull in two geometry kernels that check each other.\n"
      "Lengths are in mm, angles in degrees, coordinates in DICOM's patient frame (LPS).",
      "octotomy");
  app.set_version_flag("--version", "octotomy " OCTOTOMY_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Example:\n"
      "  octotomy phantom head -o head.nrrd\n"
      "  octotomy run planner/le_fort_i.plan.json --scan ct=head.nrrd -o report\n"
      "Exit status: 0 done, 1 a FAIL verdict (kernels that disagree, a check that fails) or verify lacks "
      "evidence, 2 wrong usage or bad input, 3 out of time, memory or disk, 70 a mistake in the program.");
  cli::add_manual(app);
  Program program(app, {arguments + std::min(1, count), arguments + count});
  cli::add_look(program);
  cli::add_plan_verbs(program);
  cli::add_verify_verbs(program);
  cli::add_info(program);
  cli::add_convert(program);
  cli::add_mark(program);
  cli::add_prepare(program);
  cli::add_operation_verbs(program);
  cli::add_phantom(program);
  cli::add_cohort(program);
  cli::add_cephalometry(program);
  cli::add_outcome(program);
  cli::add_pack(program);
  cli::add_scene(program);
  cli::add_archive_verbs(program);
  cli::add_serve(program);
  cli::group_verbs(app);
  try {
    app.parse(count, arguments);
    need_named_outputs(app);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return say_help(app, error);
    if (count > 1 && arguments[1][0] != '-' && app.get_subcommands().empty())
      return refuse(cli::unknown_verb(app, arguments[1]), cli::bad_input);
    return refuse(std::string(error.what()) + "; see octotomy --help", cli::bad_input);
  } catch (const std::filesystem::filesystem_error& error) {
    // a path is too long or lies in an inaccessible folder
    return refuse(error.path1().string() + ": " + error.code().message(), cli::bad_input);
  }
  return run_chosen(program);
}

}  // namespace

int main(int count, char** arguments) {
  heed_signals();
  std::set_terminate(end_of_no_handler);
  try {
    return parse_and_run(count, arguments);
  } catch (const std::bad_alloc&) {
    // run_chosen() throws no other error. Printing this text needs no allocation.
    std::fputs("octotomy: out of memory\n", stderr);
    return cli::out_of_resources;
  } catch (const std::exception& error) {
    return refuse(error, "");
  }
}
