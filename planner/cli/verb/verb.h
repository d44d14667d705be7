// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "planner/operation/file/file_kind.h"
#include "planner/operation/measure/result_json.h"
#include "planner/plan/evaluate.h"
#include "voxel/space/lattice.h"

namespace CLI {
class App;
}  // namespace CLI

// What the verbs of the command line have in common.
namespace octotomy::planner::cli {

/// Exit statuses. The last is EX_SOFTWARE of sysexits.h: a mistake in the program.
enum Status { done = 0, disagreement = 1, bad_input = 2, out_of_resources = 3, internal_error = 70 };

/// The program as a verb sees it.
struct Program {
  /// `words`: the command line after the program's name.
  Program(CLI::App& top, std::vector<std::string> words) : app(top), words_(std::move(words)) {}

  CLI::App& app;
  bool json = false;
  std::optional<int> threads;
  std::optional<double> time_limit_s;
  std::optional<double> memory_gb;
  std::stop_source stop;
  std::function<int()> chosen;  ///< what the verb on the command line does; its answer is the exit status

  /// Adds a verb, and where it is asked for the options that every verb has. `example` ends its --help.
  CLI::App& verb(const std::string& name, const std::string& does, const std::string& example,
                 std::function<int()> action);
  /// Whether the command line may mean this verb, which then needs its options: adding those of all verbs
  /// takes longer than most verbs' work. True of all verbs where an option comes first, as --manual.
  bool is_asked(const std::string& name) const;
  /// Keeps the audit of a scan that the verb has read for say().
  void note_scan(const std::filesystem::path& path, const voxel::Scene& scene) const;
  void note_scan(const ScanRecord& scan) const;
  /// Keeps the tissues among the words of the command line, also of NAME=TISSUE, for say().
  void note_tissues(const std::vector<std::string>& words) const;
  /// Puts the answer on standard output: the JSON object, or the text for people. Warnings and failures of
  /// the noted scans' audits go to standard error, one line each, and their audits into the JSON as "scans"
  /// if the answer holds no audit yet; the noted tissues' bounds go the same ways, as "tissues".
  void say(const Json& answer, const std::string& text) const;
  /// Whether people read on a terminal what is being done.
  bool shows_progress() const;
  /// A progress line on standard error where shows_progress(), else none.
  std::function<void(const std::string&, double)> progress() const;
  /// The same of one thing only, which the line calls `doing`.
  std::function<void(double)> progress(const std::string& doing) const;

 private:
  std::vector<std::string> words_;
  std::shared_ptr<std::vector<std::string>> tissues_ = std::make_shared<std::vector<std::string>>();
  std::shared_ptr<std::vector<ScanRecord>> scans_ = std::make_shared<std::vector<ScanRecord>>();
};

/// Says that no verb is called `word`: with the nearest one's name, and where to find them.
std::string unknown_verb(const CLI::App& app, const std::string& word);

/// One line on standard error, as line_of() makes it.
void warn(const std::string& line);

/// The same of one finding among many: the first of a run are said, so that what matters is not lost among
/// thousands.
void warn_finding(const std::string& finding);

/// A run of the program. Its end states the number of findings that warn_finding() has kept back, and forgets
/// how meshes were to be read and which were.
struct FindingsOfRun {
  FindingsOfRun() = default;
  FindingsOfRun(const FindingsOfRun&) = delete;
  FindingsOfRun& operator=(const FindingsOfRun&) = delete;
  ~FindingsOfRun();
};

/// A text as one line for a terminal: without control characters, at most 1000 bytes.
std::string line_of(const std::string& text);

/// How the program ends is said once: by the verb, or by the watch over it. True for the first that asks,
/// and for the same one again.
enum class Speaker { None, Verb, Watch };
bool has_last_word(Speaker speaker);

/// Numbers of samples for people: 512 x 512 x 300.
std::string dims_text(const glm::ivec3& dims);

/// A table of two columns for people.
std::string lines(const std::vector<std::pair<std::string, std::string>>& rows);

}  // namespace octotomy::planner::cli
