// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/verb.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <set>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "planner/cli/verb/numbers.h"
#include "planner/cli/verb/progress_line.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/table/control_character.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/same_patient.h"
#include "voxel/dicom/identity.h"
#include "voxel/filter/tissue.h"

namespace octotomy::planner::cli {
namespace {

std::atomic<Speaker> last_speaker{Speaker::None};

constexpr std::size_t most_findings = 40;  ///< largest number of findings that one run prints, about a page
std::size_t findings = 0;                  ///< number of findings of this run, printed or not

/// Writes a text to standard output completely, or throws. A closed pipe is no error, because its reader
/// needs no more.
void put(const std::string& text) {
  // If the watch prints how the process ends, waits for this end.
  while (!has_last_word(Speaker::Verb)) std::this_thread::sleep_for(std::chrono::seconds(1));
  end_progress();
  errno = 0;
  const bool written =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written && errno != EPIPE) throw std::system_error(errno, std::generic_category(), "standard output");
}

}  // namespace

CLI::App& Program::verb(const std::string& name, const std::string& does, const std::string& example,
                        std::function<int()> action) {
  // A name such as "plan diff" is the verb diff in the group plan.
  CLI::App* parent = &app;
  const auto blank = name.find(' ');
  if (blank != std::string::npos) parent = app.get_subcommand(name.substr(0, blank));
  CLI::App& sub = *parent->add_subcommand(name.substr(blank == std::string::npos ? 0 : blank + 1), does);
  if (!is_asked(sub.get_name())) return sub;
  sub.add_flag("--json", json, "One JSON object on standard output, nothing else there");
  sub.add_option("--threads", threads, "Threads to use; the answer is the same on any number")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  sub.add_option("--time-limit", time_limit_s,
                 "Stop after this number of seconds, with exit status 3 and nothing written")
      ->check(above_zero())
      ->type_name("S");
  sub.add_option("--memory", memory_gb,
                 "Use at most this many GB of memory, else exit status 3; a scan that takes more than half "
                 "of it lies in a temporary file")
      ->check(above_zero())
      ->type_name("GB");
  sub.footer("Example:\n  " + example);
  sub.callback([this, act = std::move(action)] { chosen = act; });
  return sub;
}

bool Program::is_asked(const std::string& name) const {
  return words_.empty() || words_.front().starts_with('-') ||
         std::find(words_.begin(), words_.end(), name) != words_.end();
}

namespace {

/// Compares a scan with the first one. Returns a finding if the patients differ or, if one of the two is a
/// label map, their study or frame of reference. Other scans of a patient may belong to several studies.
std::optional<voxel::Finding> doubt_of(const ScanRecord& scan, const std::vector<ScanRecord>& earlier) {
  if (earlier.empty()) return std::nullopt;
  const ScanRecord& first = earlier.front();
  const voxel::IdentityComparison found = voxel::compared(first.identity, scan.identity);
  const bool is_laid = first.meaning == voxel::Meaning::Label || scan.meaning == voxel::Meaning::Label;
  if (found.differing.empty() || (!is_laid && !found.differing.front().starts_with("patient")))
    return std::nullopt;
  return identity_finding({first.path.string(), first.identity}, {scan.path.string(), scan.identity});
}

}  // namespace

void Program::note_scan(const ScanRecord& scan) const {
  scans_->push_back(scan);
}

void Program::note_scan(const std::filesystem::path& path, const voxel::Scene& scene) const {
  ScanRecord record;
  record.path = path;
  record.lattice = scene.lattice;
  record.audit = scene.audit;
  record.holes = scene.holes;
  record.identity = scene.identity;
  record.meaning = scene.meaning;
  if (const auto finding = doubt_of(record, *scans_)) record.audit.push_back(*finding);
  note_scan(record);
}

void Program::note_tissues(const std::vector<std::string>& words) const {
  for (const std::string& word : words) {
    const std::string name = word.substr(word.find('=') + 1);
    if (voxel::tissue(name) && std::find(tissues_->begin(), tissues_->end(), name) == tissues_->end())
      tissues_->push_back(name);
  }
}

void Program::say(const Json& answer, const std::string& text) const {
  std::set<std::string> said;  // findings already printed, because a made scan repeats those of its source
  for (const ScanRecord& scan : *scans_)
    for (const voxel::Finding& finding : scan.audit) {
      const std::string line =
          std::string(to_string(finding.verdict)) + ", " + finding.check + ": " + finding.detail;
      if (finding.verdict == voxel::Verdict::Pass || (!scan.made_by.empty() && said.contains(line))) continue;
      said.insert(line);
      warn((scan.made_by.empty() ? scan.path.string() : scan.name + ", " + scan.made_by) + ": " + line);
    }
  const std::vector<MeshRecord> meshes = meshes_read(), landmarks = landmark_files_read();
  for (const std::vector<MeshRecord>* files : {&meshes, &landmarks})
    for (const MeshRecord& file : *files)
      for (const std::string& line : warnings_of(file.audit)) warn(file.path.string() + ": WARN, " + line);
  for (const std::string& choice : unused_choices())
    warn(choice + ": no mesh of that name was read, so the option has no effect");
  for (const std::string& name : *tissues_) {
    const voxel::Tissue tissue = *voxel::tissue(name);
    warn(voxel::described(tissue) + ": " + std::string(tissue.source));
  }
  if (!json) {
    std::string plain = text;
    std::replace_if(
        plain.begin(), plain.end(), [](char symbol) { return symbol != '\n' && is_control(symbol); }, '?');
    return put(plain);
  }
  Json whole = answer;
  for (const std::string& name : *tissues_) {
    const voxel::Tissue tissue = *voxel::tissue(name);
    whole["tissues"][name] = {{"low", tissue.low ? Json(*tissue.low) : Json(nullptr)},
                              {"high", tissue.high ? Json(*tissue.high) : Json(nullptr)},
                              {"unit", "HU"},
                              {"source", std::string(tissue.source)}};
  }
  if (!meshes.empty() && !whole.contains("audit") && !whole.contains("meshes"))
    for (const MeshRecord& mesh : meshes)
      whole["meshes"].push_back({{"path", mesh.path.generic_string()}, {"audit", to_json(mesh.audit)}});
  for (const MeshRecord& file : landmarks)
    whole["landmark_files"].push_back({{"path", file.path.generic_string()}, {"audit", to_json(file.audit)}});
  if (!scans_->empty() && !whole.contains("audit") && !whole.contains("scans")) {
    whole["scans"] = Json::array();
    for (const ScanRecord& scan : *scans_) {
      whole["scans"].push_back({{"path", scan.path.generic_string()}, {"audit", to_json(scan.audit)}});
      if (!scan.holes.empty()) whole["scans"].back()["interpolated"] = to_json(scan.holes, scan.lattice);
    }
  }
  put(json_text(whole, 2) + "\n");
}

bool Program::shows_progress() const {
  return !json && ::isatty(STDERR_FILENO) != 0;
}

std::function<void(const std::string&, double)> Program::progress() const {
  if (!shows_progress()) return {};
  return show_progress;
}

std::function<void(double)> Program::progress(const std::string& doing) const {
  const auto report = progress();
  if (!report) return {};
  return [report, doing](double fraction) { report(doing, fraction); };
}

std::string unknown_verb(const CLI::App& app, const std::string& word) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands({})) verbs.push_back(verb->get_name());
  const std::optional<std::string> nearest = nearest_name(word, verbs);
  return "there is no verb '" + word + "'" + (nearest ? ", did you mean '" + *nearest + "'?" : "") +
         "; see octotomy --help";
}

void warn(const std::string& line) {
  erase_progress();
  std::fprintf(stderr, "octotomy: %s\n", line_of(line).c_str());
}

void warn_finding(const std::string& finding) {
  if (++findings <= most_findings) warn(finding);
}

FindingsOfRun::~FindingsOfRun() {
  if (findings > most_findings)
    warn(std::to_string(findings - most_findings) + " more findings: --json lists them all");
  findings = 0;
  choose_mesh_reading({}, {});
}

std::string line_of(const std::string& text) {
  constexpr std::size_t most = 1000;  // in bytes, so that a message never prints a whole file
  constexpr const char* cut = " ... ";
  std::string line = text;
  while (!line.empty() && (line.back() == ' ' || line.back() == '\n')) line.pop_back();
  for (char& symbol : line)
    if (is_control(symbol)) symbol = symbol == '\n' || symbol == '\t' ? ' ' : '?';
  if (line.size() <= most) return line;
  // Keeps the beginning, which names the place, and the end, which states a remedy. Does not cut a UTF-8
  // character.
  std::size_t first = most / 2, last = line.size() - most / 2 + 5;
  while (first > 0 && (static_cast<unsigned char>(line[first]) & 0xc0) == 0x80) --first;
  while (last < line.size() && (static_cast<unsigned char>(line[last]) & 0xc0) == 0x80) ++last;
  return line.substr(0, first) + cut + line.substr(last);
}

bool has_last_word(Speaker speaker) {
  Speaker before = Speaker::None;
  return last_speaker.compare_exchange_strong(before, speaker) || before == speaker;
}

std::string dims_text(const glm::ivec3& dims) {
  return std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " + std::to_string(dims.z);
}

std::string lines(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::size_t widest = 0;
  for (const auto& [name, unused] : rows) widest = std::max(widest, name.size());
  std::string text;
  for (const auto& [name, value] : rows)
    text.append(name).append(widest - name.size() + 2, ' ').append(value).append("\n");
  return text;
}

}  // namespace octotomy::planner::cli
