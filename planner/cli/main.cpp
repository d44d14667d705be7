// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The program: reads the command line, runs the chosen verb and turns what it throws into an exit status:
// 2 for what the user can mend, 3 for time, memory and disk.
#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <sysexits.h>
#include <system_error>
#include <tbb/global_control.h>
#include <thread>
#include <vector>

#include "brep/mesh/error.h"
#include "planner/cli/manual.h"
#include "planner/cli/operation_verb.h"
#include "planner/cli/verb.h"
#include "planner/table/nearest_name.h"
#include "voxel/space/error.h"

namespace {

using octotomy::planner::cli::Program;
namespace cli = octotomy::planner::cli;

std::atomic<bool> interrupted{false};

/// Asks the verb to stop when its time is over or the user interrupts; ends with its scope.
class Watch {
 public:
  explicit Watch(Program& program)
      : thread_([this, &program](const std::stop_token& over) {
          const auto start = std::chrono::steady_clock::now();
          std::unique_lock lock(mutex_);
          while (!wake_.wait_for(lock, over, std::chrono::milliseconds(50), [] { return false; }) &&
                 !over.stop_requested()) {
            const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
            const bool late = program.time_limit_s && spent.count() > *program.time_limit_s;
            if (late || interrupted) program.stop.request_stop();
          }
        }) {}

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

/// An error's text on one line: what, where, what to try.
int refuse(const std::string& text, int status) {
  std::string line = text;
  for (char& symbol : line)
    if (symbol == '\n') symbol = ' ';
  while (!line.empty() && line.back() == ' ') line.pop_back();
  cli::warn(line);
  return status;
}

/// The exit status of a kernel's error code: both kernels name theirs alike.
template <typename Code>
int status_of(Code code) {
  return code == Code::Cancelled || code == Code::Resource ? cli::out_of_resources : cli::bad_input;
}

int run_chosen(Program& program) {
  try {
    std::unique_ptr<tbb::global_control> threads;
    if (program.threads)
      threads = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                      static_cast<std::size_t>(*program.threads));
    const Watch watch(program);
    return program.chosen();
  } catch (const CLI::ParseError& error) {
    return refuse(error.what(), cli::bad_input);
  } catch (const octotomy::voxel::Error& error) {
    return refuse(error.what(), status_of(error.code()));
  } catch (const octotomy::brep::Error& error) {
    return refuse(error.what(), status_of(error.code()));
  } catch (const std::bad_alloc&) {
    return refuse(
        "out of memory: nothing was written; use larger voxels (universe, voxel_mm) or a smaller scan",
        cli::out_of_resources);
  } catch (const std::system_error& error) {
    return refuse(error.what(), status_of(octotomy::voxel::code_of_errno(error.code().value())));
  } catch (const std::exception& error) {
    return refuse(error.what(), cli::bad_input);
  }
}

/// Nothing has that name: the nearest one, or where to find them.
std::string unknown_verb(CLI::App& app, const std::string& word) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands({})) verbs.push_back(verb->get_name());
  const std::optional<std::string> nearest = octotomy::planner::nearest_name(word, verbs);
  return "there is no verb '" + word + "'" + (nearest ? ", did you mean '" + *nearest + "'?" : "") +
         "; see octotomy --help";
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
      "Exit status: 0 done, 1 the kernels disagree or verify lacks evidence, 2 wrong usage or bad input, 3 "
      "out of time, memory or "
      "disk.");
  cli::add_manual(app);
  Program program(app);
  cli::add_look(program);
  cli::add_plan_verbs(program);
  cli::add_verify_verbs(program);
  cli::add_info(program);
  cli::add_convert(program);
  cli::add_mark(program);
  cli::add_prepare(program);
  cli::add_segment(program);
  cli::add_operation_verbs(program);
  cli::add_phantom(program);
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    if (count > 1 && arguments[1][0] != '-' && app.get_subcommands().empty())
      return refuse(unknown_verb(app, arguments[1]), cli::bad_input);
    return refuse(std::string(error.what()) + "; see octotomy --help", cli::bad_input);
  } catch (const std::filesystem::filesystem_error& error) {
    // A path that is too long, or in a folder that is closed.
    return refuse(error.path1().string() + ": " + error.code().message(), cli::bad_input);
  }
  return run_chosen(program);
}

}  // namespace

int main(int count, char** arguments) {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  try {
    return parse_and_run(count, arguments);
  } catch (const std::bad_alloc&) {
    // Of run_chosen()'s errors only this gets past it; a line that is no allocation can still be said.
    std::fputs("octotomy: out of memory\n", stderr);
    return cli::out_of_resources;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "octotomy: a mistake in the program, not in its use: %s; please report it\n",
                 error.what());
    return EX_SOFTWARE;
  }
}
