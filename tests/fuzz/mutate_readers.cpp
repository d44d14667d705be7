// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Damaged files for every reader: the verb that reads a kind of file runs on each, and one that computes on
// each that was read, with limits on time and address space. A mutant is done with (status 0, JSON on
// standard output) or refused (status 2, one line on standard error, nothing on standard output; of what
// computes also 3, want of memory or disk). Anything else - a crash, a hang, memory that the file could not
// hold - is a fault, is kept, and is the exit status.
//
// The program is loaded once a worker, since loading takes far longer than reading: LoadedProgram runs its
// cases. Those that seem faults, and of all others a sample, run as processes of their own, which decide.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/file_bytes.h"
#include "tests/fuzz/file_kinds.h"
#include "tests/fuzz/loaded_program.h"
#include "tests/fuzz/mutation.h"
#include "tests/voxel/scratch_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace octotomy::tests;
using Clock = std::chrono::steady_clock;
using Command = std::vector<std::string>;

struct Options {
  Subject subject{.program = fs::path(OCTOTOMY_BINARY_DIR) / "octotomy"};
  std::uint64_t count = 2000;
  std::uint64_t first_seed = 0;
  std::uint64_t check_every = 500;
  std::vector<std::string> readers;
  fs::path keep;
  unsigned workers = std::max(1u, std::thread::hardware_concurrency());
};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A number without the pattern of consecutive seeds.
std::uint64_t scattered(std::uint64_t seed) {
  return (seed * 0x9e3779b97f4a7c15u) >> 32;
}

/// The command with MUTANT and OUT replaced by names, and with JSON output. OUT is in the folder `out`.
std::vector<std::string> with_names(std::vector<std::string> command, const fs::path& mutant,
                                    const fs::path& folder) {
  for (std::string& word : command)
    for (const auto& [name, path] : {std::pair{std::string("MUTANT"), mutant.string()},
                                     std::pair{std::string("OUT"), (folder / "out/made").string()}})
      if (const std::size_t at = word.find(name); at != std::string::npos)
        word.replace(at, name.size(), path);
  command.emplace_back("--json");
  return command;
}

/// A loaded program, and the folder that its cases' files lie in.
struct Worker {
  Worker(const Subject& subject, const fs::path& in) : folder(in), program(subject, in) {}

  /// Writes a file of a kind to the path where the program reads it.
  void lay(const FileKind& kind, const std::string& bytes) const {
    const fs::path place = folder / kind.name;
    if (kind.is_changed) fs::remove_all(place);
    if (!fs::exists(place)) {
      fs::create_directories(place);
      for (const fs::path& other : kind.beside) fs::copy_file(other, place / other.filename());
    }
    write_bytes(place / kind.file, bytes);
  }

  LoadedProgram::Judged judge(const FileKind& kind, const std::string& bytes,
                              const std::vector<std::string>& command, bool check, bool may_lack) {
    const fs::path mutant = kind.is_folder ? folder / kind.name : folder / kind.name / kind.file;
    return program.judge(with_names(command, mutant, folder), check, may_lack, [&] {
      lay(kind, bytes);
      fs::remove_all(folder / "out");
      fs::create_directories(folder / "out");
    });
  }

  fs::path folder;
  LoadedProgram program;
};

struct Tally {
  std::uint64_t read = 0, refused = 0, computed = 0, declined = 0, checked = 0, faults = 0;
  std::size_t most_mib = 0;
  double slowest_s = 0.0;
};

/// All mutants of a kind.
class KindRun {
 public:
  KindRun(const Options& options, const FileKind& kind) : options_(options), kind_(kind) {}

  /// Requires that the sound file is read, alone and in a batch, and that new verbs accept it: a harness that
  /// only sees refusals tests nothing.
  void need_sound(Worker& worker, bool has_new_verbs) const {
    const std::string sound = kind_.finish ? kind_.finish(kind_.sound) : kind_.sound;
    const auto need_taken = [&](const std::vector<std::string>& command, bool computes) {
      const auto judged = worker.judge(kind_, sound, command, !computes, computes);
      if (!judged.fault.empty() || judged.outcome.status >= (computes ? 2 : 1))
        throw std::runtime_error(kind_.name + ": '" + command.front() +
                                 "' does not take the sound file: " + judged.fault + judged.outcome.errors);
    };
    need_taken(kind_.command, false);
    if (!has_new_verbs) return;
    for (const Command& verb : kind_.verbs) need_taken(verb, true);
  }

  Tally run(const std::vector<std::unique_ptr<Worker>>& workers) {
    const Clock::time_point begin = Clock::now();
    std::vector<std::jthread> threads;
    for (const std::unique_ptr<Worker>& worker : workers)
      threads.emplace_back([this, &worker] {
        try {
          for (std::uint64_t i = next_++; i < options_.count; i = next_++)
            judge(*worker, options_.first_seed + i);
        } catch (...) {
          const std::lock_guard lock(mutex_);
          thrown_ = std::current_exception();
        }
      });
    threads.clear();
    if (thrown_) std::rethrow_exception(thrown_);
    std::printf(
        "%-18s %6llu read %6llu refused; of those read %6llu computed %6llu declined; %4llu checked %4llu "
        "faults   at most %4zu MiB, %5.2f s, %6.0f a second\n",
        kind_.name.c_str(), number(tally_.read), number(tally_.refused), number(tally_.computed),
        number(tally_.declined), number(tally_.checked), number(tally_.faults), tally_.most_mib,
        tally_.slowest_s, static_cast<double>(options_.count) / seconds_since(begin));
    std::fflush(stdout);
    return tally_;
  }

 private:
  static unsigned long long number(std::uint64_t count) { return count; }

  void judge(Worker& worker, std::uint64_t seed) {
    const auto mutation = static_cast<Mutation>(seed % mutation_count);
    std::string mutant = mutated(kind_.sound, mutation, seed / mutation_count);
    // For a kind that is packed or sealed, only in every other round of kinds; unpacked, it would not be of
    // that kind.
    if (kind_.finish && ((seed / mutation_count) % 2 == 0)) mutant = kind_.finish(mutant);
    const bool is_checked = scattered(seed + 1) % options_.check_every == 0;
    const auto pass = [&](const std::vector<std::string>& command, bool computes) {
      const Clock::time_point begin = Clock::now();
      const auto judged = worker.judge(kind_, mutant, command, is_checked, computes);
      count(judged, seconds_since(begin), is_checked, computes);
      if (!judged.fault.empty()) tell(mutant, seed, command.front(), judged.fault);
      return judged.fault.empty() && judged.outcome.status == 0;
    };
    const bool is_slow = !kind_.slow_verbs.empty() && scattered(seed + 3) % 256 == 0;
    const std::vector<Command>& verbs = is_slow ? kind_.slow_verbs : kind_.verbs;
    if (pass(kind_.command, false) && !verbs.empty()) pass(verbs[scattered(seed + 2) % verbs.size()], true);
  }

  void count(const LoadedProgram::Judged& judged, double seconds, bool is_checked, bool computes) {
    const std::lock_guard lock(mutex_);
    tally_.most_mib = std::max(tally_.most_mib, judged.outcome.resident_mib);
    tally_.slowest_s = std::max(tally_.slowest_s, seconds);
    tally_.checked += is_checked ? 1 : 0;
    if (!judged.fault.empty())
      ++tally_.faults;
    else if (judged.outcome.status < 2)
      ++(computes ? tally_.computed : tally_.read);
    else
      ++(computes ? tally_.declined : tally_.refused);
  }

  void tell(const std::string& mutant, std::uint64_t seed, const std::string& verb,
            const std::string& fault) {
    const std::lock_guard lock(mutex_);
    std::printf("FAULT %s, seed %llu (%s), %s: %s\n  mutate_readers --reader %s --seed %llu --count 1\n",
                kind_.name.c_str(), number(seed), name_of(static_cast<Mutation>(seed % mutation_count)),
                verb.c_str(), fault.c_str(), kind_.name.c_str(), number(seed));
    std::fflush(stdout);
    if (options_.keep.empty()) return;
    fs::create_directories(options_.keep);
    write_bytes(options_.keep / (kind_.name + "_" + std::to_string(seed) + "_" + kind_.file), mutant);
  }

  const Options& options_;
  const FileKind& kind_;
  std::atomic<std::uint64_t> next_ = 0;
  std::mutex mutex_;
  std::exception_ptr thrown_;
  Tally tally_;
};

int judge_kinds(const Options& options) {
  const ScratchFolder scratch;
  const fs::path sound_files = scratch / "sound_files";
  fs::create_directories(sound_files);
  Subject unhurried = options.subject;
  unhurried.seconds = 120.0;
  unhurried.address_space_mib = std::size_t{1} << 14;
  const std::vector<FileKind> kinds = file_kinds(sound_files, [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = run_alone(unhurried, arguments, scratch.path());
    if (outcome.status != 0)
      throw std::runtime_error("'" + arguments.front() + "' made no sound file: " + outcome.errors);
  });
  std::vector<std::unique_ptr<Worker>> workers;
  for (unsigned worker = 0; worker < options.workers; ++worker) {
    const fs::path folder = scratch / ("worker" + std::to_string(worker));
    fs::create_directories(folder);
    workers.push_back(std::make_unique<Worker>(options.subject, folder));
  }
  std::uint64_t faults = 0;
  std::size_t judged = 0;
  std::set<std::vector<std::vector<std::string>>> tried;  // lists of verbs, which kinds share
  for (const FileKind& kind : kinds) {
    const bool wanted = options.readers.empty() || std::find(options.readers.begin(), options.readers.end(),
                                                             kind.name) != options.readers.end();
    if (!wanted) continue;
    KindRun run(options, kind);
    run.need_sound(*workers.front(), tried.insert(kind.verbs).second);
    faults += run.run(workers).faults;
    ++judged;
  }
  if (judged == 0) throw std::runtime_error("no reader of that name");
  return faults == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    Options options;
    CLI::App app(
        "Damages sound files for every reader and has octotomy read each, and compute with what it read.",
        "mutate_readers");
    app.add_option("--count", options.count, "Mutants a reader")->capture_default_str();
    app.add_option("--seed", options.first_seed, "Number of the first mutant")->capture_default_str();
    app.add_option("--reader", options.readers, "Only these, for example nrrd; default: all");
    app.add_option("--program", options.subject.program, "The octotomy to run")->capture_default_str();
    app.add_option("--keep", options.keep, "A folder for mutants that show a fault");
    app.add_option("--seconds", options.subject.seconds, "Time limit of one case")->capture_default_str();
    app.add_option("--batch", options.subject.batch, "Cases one after the other in a process that is forked")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--check", options.check_every, "One case of so many also runs as a process of its own")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--workers", options.workers, "Cases at a time")->capture_default_str();
    app.footer("Example:\n  build/release/mutate_readers --count 2000 --keep faults");
    CLI11_PARSE(app, count, arguments);
    return judge_kinds(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mutate_readers: %s\n", error.what());
    return 2;
  }
}
