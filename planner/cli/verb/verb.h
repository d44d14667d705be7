// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "planner/operation/file/path_checks.h"
#include "planner/operation/measure/result_json.h"
#include "planner/plan/evaluate.h"
#include "voxel/space/lattice.h"

namespace CLI {
class App;
}  // namespace CLI

// Common parts of all verbs of the command line.
namespace octotomy::planner::cli {

/// Exit statuses. The last is EX_SOFTWARE of sysexits.h: a mistake in the program.
enum Status { done = 0, disagreement = 1, bad_input = 2, out_of_resources = 3, internal_error = 70 };

/// The program as verbs use it: the common options, and functions that print.
struct Program {
  /// `words`: the command line after the program's name.
  Program(CLI::App& top, std::vector<std::string> words) : app(top), words_(std::move(words)) {}

  CLI::App& app;
  bool json = false;
  std::optional<int> threads;
  std::optional<double> time_limit_s;
  std::optional<double> memory_gb;
  std::stop_source stop;
  std::function<int()> chosen;  ///< runs the verb that the command line names; returns the exit status

  /// Adds a verb. If the command line requests it, also adds the options that all verbs have. `example` is
  /// the end of its --help.
  CLI::App& verb(const std::string& name, const std::string& does, const std::string& example,
                 std::function<int()> action);
  /// Whether the command line may request this verb. Only then are its options added, because adding those of
  /// all verbs takes longer than the work of most verbs. True for all verbs if an option such as --manual
  /// comes first.
  bool is_asked(const std::string& name) const;
  /// Stores the audit of a scan that the verb has read. say() prints it.
  void note_scan(const std::filesystem::path& path, const voxel::Scene& scene) const;
  void note_scan(const ScanRecord& scan) const;
  /// Stores the tissues that words of the command line name, also in the form NAME=TISSUE. say() prints their
  /// bounds.
  void note_tissues(const std::vector<std::string>& words) const;
  /// Prints the answer to standard output, as JSON or as text. Prints each WARN and FAIL of the stored audits
  /// to standard error, on one line each, and adds the audits to the JSON as "scans" if the answer contains
  /// none. Prints the bounds of the stored tissues and adds them as "tissues" in the same way.
  void say(const Json& answer, const std::string& text) const;
  /// Whether progress is shown, that is, standard error is a terminal.
  bool shows_progress() const;
  /// A function that shows a progress line on standard error if shows_progress(); none otherwise.
  std::function<void(const std::string&, double)> progress() const;
  /// The same for a verb with a single task, whose name is `doing`.
  std::function<void(double)> progress(const std::string& doing) const;

 private:
  std::vector<std::string> words_;
  std::shared_ptr<std::vector<std::string>> tissues_ = std::make_shared<std::vector<std::string>>();
  std::shared_ptr<std::vector<ScanRecord>> scans_ = std::make_shared<std::vector<ScanRecord>>();
};

/// The message for a word that is no verb. It proposes the most similar verb and the command that lists the
/// verbs.
std::string unknown_verb(const CLI::App& app, const std::string& word);

/// Prints one line, formatted by line_of(), to standard error.
void warn(const std::string& line);

/// Prints a finding that may be one of thousands. Only the first ones of a run are printed, so that a
/// terminal still shows other messages.
void warn_finding(const std::string& finding);

/// One run of the program. The destructor prints how many findings warn_finding() has not printed, and resets
/// the options for reading meshes and the list of meshes.
struct FindingsOfRun {
  FindingsOfRun() = default;
  FindingsOfRun(const FindingsOfRun&) = delete;
  FindingsOfRun& operator=(const FindingsOfRun&) = delete;
  ~FindingsOfRun();
};

/// A text as one line of at most 1000 bytes without control characters.
std::string line_of(const std::string& text);

/// Decides whether verb or watch prints how the process ends. Returns true to the first one that calls, and
/// for all its later calls.
enum class Speaker { None, Verb, Watch };
bool has_last_word(Speaker speaker);

/// Three numbers of samples as text, such as "512 x 512 x 300".
std::string dims_text(const glm::ivec3& dims);

/// A table of two aligned columns, one line for each row.
std::string lines(const std::vector<std::pair<std::string, std::string>>& rows);

}  // namespace octotomy::planner::cli
