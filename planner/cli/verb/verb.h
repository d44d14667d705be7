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

// Common parts of the verbs of the command line.
namespace octotomy::planner::cli {

/// Exit statuses. The last is EX_SOFTWARE of sysexits.h: a mistake in the program.
enum Status { done = 0, disagreement = 1, bad_input = 2, out_of_resources = 3, internal_error = 70 };

/// The program's interface for verbs.
struct Program {
  /// `words`: the command line after the program's name.
  Program(CLI::App& top, std::vector<std::string> words) : app(top), words_(std::move(words)) {}

  CLI::App& app;
  bool json = false;
  std::optional<int> threads;
  std::optional<double> time_limit_s;
  std::optional<double> memory_gb;
  std::stop_source stop;
  std::function<int()> chosen;  ///< runs the verb on the command line; returns the exit status

  /// Adds a verb and, if it is requested, the options common to all verbs. `example` ends its --help.
  CLI::App& verb(const std::string& name, const std::string& does, const std::string& example,
                 std::function<int()> action);
  /// Whether the command line may request this verb, which then needs its options: adding those of all verbs
  /// takes longer than most verbs' work. True for all verbs if an option comes first, such as --manual.
  bool is_asked(const std::string& name) const;
  /// Stores the audit of a scan that the verb has read, for say().
  void note_scan(const std::filesystem::path& path, const voxel::Scene& scene) const;
  void note_scan(const ScanRecord& scan) const;
  /// Stores the tissues among the words of the command line, also of NAME=TISSUE, for say().
  void note_tissues(const std::vector<std::string>& words) const;
  /// Prints the answer to standard output: the JSON object, or the text. Prints warnings and failures of the
  /// noted scans' audits to standard error, one line each, and adds the audits to the JSON as "scans" if the
  /// answer contains no audit. Treats the noted tissues' bounds in the same way, as "tissues".
  void say(const Json& answer, const std::string& text) const;
  /// Whether progress is shown, that is, standard error is a terminal.
  bool shows_progress() const;
  /// A progress line on standard error if shows_progress(), else none.
  std::function<void(const std::string&, double)> progress() const;
  /// Reports the progress of a single task, which the line calls `doing`.
  std::function<void(double)> progress(const std::string& doing) const;

 private:
  std::vector<std::string> words_;
  std::shared_ptr<std::vector<std::string>> tissues_ = std::make_shared<std::vector<std::string>>();
  std::shared_ptr<std::vector<ScanRecord>> scans_ = std::make_shared<std::vector<ScanRecord>>();
};

/// The message that no verb has the name `word`, with the nearest verb's name and the command that lists the
/// verbs.
std::string unknown_verb(const CLI::App& app, const std::string& word);

/// Prints one line, formatted by line_of(), to standard error.
void warn(const std::string& line);

/// Warns of one finding of many: only the first ones of a run are printed, so that important ones are not
/// lost among thousands.
void warn_finding(const std::string& finding);

/// A run of the program. Its destructor prints the number of findings that warn_finding() has suppressed, and
/// resets the options for reading meshes and the list of meshes read.
struct FindingsOfRun {
  FindingsOfRun() = default;
  FindingsOfRun(const FindingsOfRun&) = delete;
  FindingsOfRun& operator=(const FindingsOfRun&) = delete;
  ~FindingsOfRun();
};

/// A text as one line for a terminal: without control characters, at most 1000 bytes.
std::string line_of(const std::string& text);

/// Only one of verb and watch prints how the program ends. True for the first caller, and for the same one
/// again.
enum class Speaker { None, Verb, Watch };
bool has_last_word(Speaker speaker);

/// Numbers of samples as text: 512 x 512 x 300.
std::string dims_text(const glm::ivec3& dims);

/// A table of two columns as text.
std::string lines(const std::vector<std::pair<std::string, std::string>>& rows);

}  // namespace octotomy::planner::cli
