// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/participant.h"

#include <chrono>
#include <fcntl.h>
#include <map>
#include <new>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include "brep/mesh/error.h"
#include "planner/cohort/cohort_folder.h"
#include "planner/cohort/result_rows.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/plan/dependence.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/rebase.h"
#include "planner/plan/sha256.h"
#include "planner/result/report/report.h"
#include "planner/result/report/result_folder.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
constexpr int picture_px = 240;
constexpr const char* report_folder = "report";

/// A process's exclusive claim on a subject, by a lock that ends with the process. `is_ours()`: this process
/// has the claim.
class Claim {
 public:
  Claim(const fs::path& out, const Subject& subject) {
    const fs::path locks = cohort_locks(out);
    fs::create_directories(locks);
    const fs::path path = locks / subject.label;
    file_ = open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
    if (file_ < 0) throw std::system_error(errno, std::generic_category(), path.string());
    is_ours_ = flock(file_, LOCK_EX | LOCK_NB) == 0;
  }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  ~Claim() { close(file_); }
  bool is_ours() const { return is_ours_; }

 private:
  int file_ = -1;
  bool is_ours_ = false;
};

std::string key_of(const Plan& plan, const Subject& subject) {
  // The 2 is the version of the format of subject.json and rows.csv: answers in an earlier format are
  // computed again.
  std::string text = OCTOTOMY_VERSION " 2\n" + plan_sha256(Json::parse(plan.text)) + "\n";
  for (const auto& [name, path] : subject.scans) text += name + " " + sha256_of_path(path) + "\n";
  for (const Step& step : plan.steps)
    for (const fs::path& file : files_read(step))
      if (fs::is_regular_file(plan.folder / file)) text += sha256_of_path(plan.folder / file) + "\n";
  return sha256_of(text);
}

/// The bytes of a file. Empty if it is not a regular file, because reading a pipe would block.
std::string bytes_of_regular(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) ? voxel::file_bytes(path) : "";
}

/// Checks a file of a subject's answer against `list`, the list of files in its folder. None if it agrees.
/// Otherwise a record with the state Missing or Changed.
std::optional<SubjectRecord> record_of_loss(const fs::path& path, const ResultList& list) {
  const auto listed = list.find(path.filename().string());
  if (listed != list.end() && listed->second == sha256_of(bytes_of_regular(path))) return std::nullopt;
  const bool is_there = fs::exists(fs::symlink_status(path));
  SubjectRecord record;
  record.state = is_there ? SubjectRecord::State::Changed : SubjectRecord::State::Missing;
  record.reason =
      path.string() +
      (is_there
           ? ": is not as Octotomy wrote it, by the list .octotomy-result beside it: move or delete it, then "
           : ": is missing: ") +
      "evaluate the subject again";
  return record;
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

Json to_json(const SubjectRecord& record, const Subject& subject) {
  Json scans = Json::object();
  for (const auto& [name, path] : subject.scans) scans[name] = path.string();
  return {{"octotomy", OCTOTOMY_VERSION},
          {"subject", subject.label},
          {"state", to_string(record.state)},
          {"reason", record.reason.empty() ? Json(nullptr) : Json(record.reason)},
          {"fault", record.fault ? Json(to_string(*record.fault)) : Json(nullptr)},
          {"audit_findings", record.audit_findings},
          {"key", record.key},
          {"scans", scans},
          {"scan_bytes", record.scan_bytes},
          {"seconds", record.seconds},
          {"peak_mb", record.peak_mb}};
}

/// A small PNG of the plan's final scene; empty if there is nothing to show.
std::vector<std::uint8_t> picture_of(const Plan& plan, const Evaluation& evaluation) {
  const FinalScene scene = final_scene(plan, evaluation);
  PictureGroup group{"picture", "", scene.after, {}};
  draw(group, {"30,10"}, scene.after, picture_px);
  return group.pictures.empty() ? std::vector<std::uint8_t>{} : group.pictures.front().png;
}

/// The plan for one subject: files that its steps read, and that are not beside the plan, are replaced by the
/// subject's own.
Plan of_subject(const Plan& plan, const Subject& subject) {
  std::map<fs::path, fs::path> places;
  for (const Step& step : plan.steps)
    for (const fs::path& file : files_read(step)) {
      if (file.is_absolute() || fs::exists(plan.folder / file)) continue;
      if (fs::path own = file_of_subject(subject, file); !own.empty()) places[file] = std::move(own);
    }
  return with_files(plan, places);
}

/// Evaluates the plan and writes the answer into `folder`. Returns the findings of the scans' audits.
ScanAudits answer(const Plan& plan, const Subject& subject, const ParticipantOptions& options,
                  const fs::path& folder) {
  Result result;
  result.plan = plan;
  result.anonymous = true;  // only labels identify the subjects of a cohort
  for (auto& [name, scan] : result.plan.scans) scan.path = subject.scans.at(name);
  result.evaluation = evaluate(result.plan, {options.stop, options.progress, true});
  Json json;
  if (options.reports) {
    result.pictures = plan_pictures(result.plan, result.evaluation);
    // The report needs no list of its own: its files are listed with those of `folder`.
    voxel::create_folders_in(folder, report_folder);
    json = write_result_files(result, folder / report_folder, {options.stop, options.progress});
  } else {
    result.measurements = measurements_json(result.plan, result.evaluation);
    json = result_json(result);
  }
  std::string rows = long_header();
  for (const ResultRow& row : rows_of(json, subject.label)) rows += long_line(row);
  voxel::write_file(folder / "rows.csv", rows);
  voxel::write_file(folder / "result.json", json.dump() + "\n");
  if (const std::vector<std::uint8_t> png = picture_of(result.plan, result.evaluation); !png.empty())
    voxel::write_file(folder / "picture.png", {png.begin(), png.end()});
  return scan_audits_of(json);
}

/// Names of the files in a subject's folder that its answer consists of, relative to the folder.
std::vector<fs::path> needed_names(const Plan& plan, const ParticipantOptions& options) {
  std::vector<fs::path> names{"rows.csv", "result.json", "picture.png", "subject.json"};
  if (options.reports)
    for (const fs::path& name : result_names(plan)) names.push_back(report_folder / name);
  return names;
}

/// Runs the work, unless an earlier one has failed for this subject. An exception is stored in the record as
/// the subject's failure. Stops, and errors of the system, memory, disk or time, are rethrown, because the
/// subject is not their cause.
template <typename Work>
void attempt(SubjectRecord& record, const Work& work) {
  if (!record.reason.empty()) return;
  try {
    work();
  } catch (const std::system_error&) {
    throw;
  } catch (const std::exception& error) {
    const Fault fault = fault_of(error);
    if (fault == Fault::Cancelled || fault == Fault::Resource) throw;
    record.reason = message_of(error);
    record.fault = fault;
  }
}

}  // namespace

std::string to_string(SubjectRecord::State state) {
  switch (state) {
    case SubjectRecord::State::Done:
      return "done";
    case SubjectRecord::State::Doubtful:
      return "doubtful";
    case SubjectRecord::State::Failed:
      return "failed";
    case SubjectRecord::State::Changed:
      return "changed";
    default:
      return "missing";
  }
}

SubjectRecord subject_record(const fs::path& out, const Subject& subject) {
  const fs::path folder = out / subject.folder();
  SubjectRecord record;
  record.reason = "no result: its process was killed, or never ran";
  if (!fs::exists(fs::symlink_status(folder / "subject.json"))) return record;
  const ResultList list = result_list(folder);
  if (const auto loss = record_of_loss(folder / "subject.json", list)) return *loss;
  const Json json = Json::parse(bytes_of_regular(folder / "subject.json"), nullptr, false);
  if (!json.is_object() || !json.contains("state")) return record;
  const std::string state = json.value("state", "");
  if (state != "done" && state != "doubtful" && state != "failed") return record;
  record.state = state == "done"       ? SubjectRecord::State::Done
                 : state == "doubtful" ? SubjectRecord::State::Doubtful
                                       : SubjectRecord::State::Failed;
  record.reason = json["reason"].is_string() ? json["reason"].get<std::string>() : "";
  if (const auto fault = json.find("fault"); fault != json.end() && fault->is_string())
    record.fault = fault_named(fault->get<std::string>());
  record.audit_findings = json.value("audit_findings", std::vector<std::string>{});
  record.key = json.value("key", "");
  record.seconds = json.value("seconds", 0.0);
  record.peak_mb = json.value("peak_mb", 0.0);
  record.scan_bytes = json.value("scan_bytes", std::uint64_t{0});
  if (record.has_answer())
    for (const char* name : {"rows.csv", "result.json"})
      if (const auto loss = record_of_loss(folder / name, list)) return *loss;
  return record;
}

SubjectRecord run_participant(const Plan& given, const Subject& subject, const fs::path& out,
                              const ParticipantOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const Claim claim(out, subject);
  SubjectRecord record;
  if (!claim.is_ours()) {
    record.is_another_at_work = true;
    return record;
  }
  SubjectRecord earlier = subject_record(out, subject);
  if (earlier.state == SubjectRecord::State::Changed) return earlier;
  record.scan_bytes = subject.scan_bytes();
  record.reason = subject.trouble;
  if (!record.reason.empty()) record.fault = Fault::Input;
  Plan plan = given;
  attempt(record, [&] { plan = of_subject(given, subject); });
  attempt(record, [&] { record.key = key_of(plan, subject); });
  if (!options.again && record.reason.empty() && earlier.has_answer() && earlier.key == record.key) {
    earlier.was_kept = true;
    return earlier;
  }
  const fs::path place = out / subject.folder();
  need_result_folder(place, needed_names(plan, options));
  ResultFolder folder(place);
  ScanAudits audits;
  attempt(record, [&] { audits = answer(plan, subject, options, folder.path()); });
  record.audit_findings = audits.findings;
  record.state = !record.reason.empty() ? SubjectRecord::State::Failed
                 : audits.fails()       ? SubjectRecord::State::Doubtful
                                        : SubjectRecord::State::Done;
  record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  record.peak_mb = peak_mb();
  voxel::write_file(folder.path() / "subject.json", to_json(record, subject).dump(2) + "\n");
  folder.publish();
  return record;
}

}  // namespace octotomy::planner
