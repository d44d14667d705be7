// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/verb.h"
#include "planner/cohort/cohort_folder.h"
#include "planner/cohort/engine.h"
#include "planner/cohort/forecast.h"
#include "planner/cohort/group.h"
#include "planner/cohort/participant.h"
#include "planner/cohort/result_rows.h"
#include "planner/cohort/statistics.h"
#include "planner/cohort/subjects.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/csv.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/number_format.h"
#include "planner/plan/dependence.h"
#include "planner/plan/rebase.h"
#include "planner/result/report/result_folder.h"
#include "voxel/space/file_text.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct CohortText {
  fs::path in, out, plan, against;
  std::string level, engine = "serial";
  std::vector<std::string> labels, slurm;
  std::optional<int> jobs;
  bool again = false, reports = false, dry_run = false;
};

/// The plan of --plan, or the plan that the cohort has stored. The paths of files that its steps read are
/// made relative to the stored plan's folder, so that later calls without --plan read the same files.
Plan plan_of(const CohortText& text) {
  const fs::path path = text.plan.empty() ? cohort_plan(text.out) : text.plan;
  if (text.plan.empty() && !fs::exists(path))
    throw std::runtime_error("--plan is missing: name the plan to run on every subject's scans");
  const Plan plan = read_plan(path);
  // Paths of scans need no change, because each subject has its own scans.
  const bool reads_files = std::any_of(plan.steps.begin(), plan.steps.end(),
                                       [](const Step& step) { return !files_read(step).empty(); });
  return reads_files ? rebased(plan, cohort_plan(text.out).parent_path()) : plan;
}

/// The command with which an engine starts a process for `level`. Omits --time-limit: it ends this process,
/// and with it the processes of the engines serial and parallel. Jobs of slurm have --slurm=--time.
std::vector<std::string> command(const Program& program, const CohortText& text, const std::string& level) {
  std::vector<std::string> words{
      fs::read_symlink("/proc/self/exe").string(),
      "cohort",
      fs::absolute(text.in).string(),
      fs::absolute(text.out).string(),
      level,
      "--plan",
      fs::absolute(text.plan.empty() ? cohort_plan(text.out) : text.plan).string()};
  if (program.threads) words.insert(words.end(), {"--threads", std::to_string(*program.threads)});
  if (program.memory_gb) words.insert(words.end(), {"--memory", csv_number(program.memory_gb)});
  if (level == "participant" && text.again) words.emplace_back("--again");
  if (level == "participant" && text.reports) words.emplace_back("--reports");
  return words;
}

/// The files and folders that this call will write into the cohort's folder.
CohortNeeds needs_of(const CohortText& text, const Plan& plan, const std::vector<Subject>& subjects) {
  CohortNeeds needs;
  if (!text.plan.empty()) needs.plan_text = plan.text;
  if (text.level == "group" || text.engine == "slurm") needs.folders.emplace_back("group");
  if (text.level == "group") return needs;
  for (const Subject& subject : subjects) needs.folders.push_back(subject.folder());
  if (text.engine == "parallel") needs.files = {cohort_labels, cohort_log};
  if (text.engine == "slurm") needs.files = {cohort_labels, cohort_participant_script, cohort_group_script};
  return needs;
}

Json json_of(const Subject& subject, const SubjectRecord& record) {
  return {{"subject", subject.label},
          {"state", record.is_another_at_work ? "in hand" : to_string(record.state)},
          {"kept", record.was_kept},
          {"reason", record.reason.empty() ? Json(nullptr) : Json(record.reason)},
          {"fault", record.fault ? Json(to_string(*record.fault)) : Json(nullptr)},
          {"audit_findings", record.audit_findings},
          {"seconds", record.seconds},
          {"peak_mb", record.peak_mb}};
}

/// Prints the subjects' records, and the WARN and FAIL of their scans' audits. Returns the exit status: 0 if
/// jobs were submitted, or if every subject has an answer or another process works on it; else 70 if a
/// mistake in the program ended one, else 3 if a process ran out of time, memory or disk (`ran_out`), else 2.
int say_records(const Program& program, const std::vector<Subject>& subjects,
                const std::vector<SubjectRecord>& records, const std::vector<std::string>& jobs,
                const std::vector<std::string>& findings, bool ran_out) {
  Json json = answer({});
  json["findings"] = findings;
  for (const std::string& finding : findings) warn_finding(finding);
  json["subjects"] = Json::array();
  json["jobs"] = jobs;
  std::size_t done_count = 0, doubtful = 0, in_hand = 0;
  bool is_internal = false;
  for (std::size_t i = 0; i < records.size(); ++i) {
    json["subjects"].push_back(json_of(subjects[i], records[i]));
    done_count += records[i].state == SubjectRecord::State::Done ? 1 : 0;
    doubtful += records[i].state == SubjectRecord::State::Doubtful ? 1 : 0;
    in_hand += records[i].is_another_at_work ? 1 : 0;
    is_internal |= records[i].fault == Fault::Internal;
    if (!records[i].has_answer() && !records[i].is_another_at_work && jobs.empty())
      warn_finding(subjects[i].label + ": " + records[i].reason);
  }
  // Findings of doubtful subjects come first, because only the first findings of a run are printed.
  for (const bool are_doubtful : {true, false})
    for (std::size_t i = 0; i < records.size() && jobs.empty(); ++i)
      for (const std::string& finding : records[i].audit_findings)
        if ((records[i].state == SubjectRecord::State::Doubtful) == are_doubtful)
          warn_finding(subjects[i].label + ": " + finding);
  json["done"] = done_count;
  json["doubtful"] = doubtful;
  json["without_answer"] = records.size() - done_count - doubtful - in_hand;
  std::string said =
      std::to_string(done_count) + " of " + std::to_string(subjects.size()) + " subjects done\n";
  if (doubtful > 0) said += std::to_string(doubtful) + " doubtful: the audit of a scan has a FAIL\n";
  if (!jobs.empty())
    said = "submitted: job " + jobs.front() + " and on; the group is job " + jobs.back() + "\n";
  program.say(json, said);
  if (!jobs.empty() || done_count + doubtful + in_hand == records.size()) return done;
  return is_internal ? internal_error : ran_out ? out_of_resources : bad_input;
}

int participants(const Program& program, const CohortText& text, const Plan& plan,
                 const std::vector<Subject>& subjects, const std::vector<std::string>& findings) {
  if (subjects.size() == 1 && text.engine == "serial") {
    const SubjectRecord record =
        run_participant(plan, subjects.front(), text.out,
                        {program.stop.get_token(), program.progress(), text.again, text.reports});
    return say_records(program, subjects, {record}, {}, findings, false);
  }
  EngineRequest request{command(program, text, "participant"),
                        command(program, text, "group"),
                        {},
                        fs::absolute(text.out),
                        text.jobs,
                        text.slurm,
                        program.stop.get_token(),
                        program.progress()};
  for (const Subject& subject : subjects) request.labels.push_back(subject.label);
  std::vector<std::string> jobs;
  bool ran_out = false;
  if (text.engine == "slurm")
    jobs = submit_slurm(request);
  else if (text.engine == "parallel")
    ran_out = run_parallel(request);
  else
    ran_out = run_serial(request);
  std::vector<SubjectRecord> records;
  for (const Subject& subject : subjects) records.push_back(subject_record(text.out, subject));
  return say_records(program, subjects, records, jobs, findings, ran_out);
}

/// Prints the time and memory that the remaining subjects will need, estimated from finished subjects.
int dry_run(const Program& program, const CohortText& text, const std::vector<Subject>& subjects) {
  std::vector<SubjectRecord> done_records;
  std::uint64_t bytes = 0, largest = 0;
  std::size_t to_do = 0;
  for (const Subject& subject : subjects) {
    const SubjectRecord record = subject_record(text.out, subject);
    if (record.has_answer() && record.scan_bytes > 0) done_records.push_back(record);
    if (record.has_answer() && !text.again) continue;
    ++to_do;
  }
  const Forecast forecast = forecast_of(done_records);
  double seconds = 0.0, peak_mb = 0.0;
  for (const Subject& subject : subjects) {
    if (!text.again && subject_record(text.out, subject).has_answer()) continue;
    const std::uint64_t size = subject.scan_bytes();
    bytes += size;
    largest = std::max(largest, size);
    seconds += forecast.seconds.of(size);
    peak_mb = std::max(peak_mb, forecast.peak_mb.of(size));
  }
  const int jobs = text.jobs.value_or(1);
  Json json = answer({});
  const bool knows = forecast.learnt_from > 0;
  json["subjects"] = subjects.size();
  json["to_do"] = to_do;
  json["scan_bytes"] = bytes;
  json["largest_scan_bytes"] = largest;
  json["learnt_from"] = forecast.learnt_from;
  json["jobs"] = jobs;
  json["hours"] = knows ? Json(seconds / 3600.0 / jobs) : Json(nullptr);
  json["peak_gb_a_job"] = knows ? Json(peak_mb / 1024.0) : Json(nullptr);
  json["findings"] = Json::array();
  if (!knows)
    json["findings"].push_back(
        "time and memory cannot be estimated yet: run three subjects of different size first");
  program.say(
      json, lines({{"to do", std::to_string(to_do) + " of " + std::to_string(subjects.size()) + " subjects"},
                   {"scans", grouped(static_cast<double>(bytes) / 1e9, 2) + " GB"},
                   {"time", knows ? grouped(seconds / 3600.0 / jobs, 2) + " h with " + std::to_string(jobs) +
                                        " at a time; finished subjects in this estimate: " +
                                        std::to_string(forecast.learnt_from)
                                  : "not known: run three subjects of different size first"},
                   {"memory", knows ? grouped(peak_mb / 1024.0, 2) + " GB each" : "not known"}}));
  return done;
}

int cohort(Program& program, const CohortText& text) {
  if (text.level == "participant") end_with_engine();
  const Plan plan = plan_of(text);
  const std::vector<Subject> all = find_subjects(text.in, plan);
  const std::vector<Subject> subjects = chosen_subjects(all, text.labels);
  // Doubts about the whole cohort are printed only if no labels are given. Engines give one label to each
  // process, and each would repeat them.
  std::vector<std::string> doubts;
  if (text.labels.empty()) doubts = doubts_of_cohort(text.in, plan, all);
  if (text.dry_run) return dry_run(program, text, subjects);
  const CohortNeeds needs = needs_of(text, plan, subjects);
  need_cohort_folder(text.out, needs);
  prepare_cohort_folder(text.out, needs.plan_text);
  if (text.level == "participant") return participants(program, text, plan, subjects, doubts);
  GroupOptions options{program.stop.get_token(), program.progress(), {}, doubts};
  if (!text.against.empty()) options.against = text.against;
  Json json = answer({});
  json.update(merge_group(subjects, text.out, options));
  for (const Json& finding : json["findings"]) warn_finding(finding.get<std::string>());
  const auto doubtful = json["doubtful"].get<std::size_t>();
  program.say(json, std::to_string(json["done"].get<std::size_t>() + doubtful) + " of " +
                        std::to_string(subjects.size()) + " subjects merged" +
                        (doubtful == 0 ? "" : ", " + std::to_string(doubtful) + " of them doubtful") +
                        "\nwritten: " + (text.out / "group/index.html").string() + "\n");
  return done;
}

struct TableText {
  std::vector<fs::path> results;
  fs::path out;
  bool wide = false;
};

Json read_result(const fs::path& path) {
  std::ifstream file = voxel::opened(path);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  Json json = Json::parse(text, nullptr, false);
  if (!file || !json.is_object() || !json.contains("octotomy"))
    throw std::runtime_error(path.string() + ": is no result.json of a plan");
  return json;
}

/// Refuses an output path at which a result, or a file of a result, would be replaced.
void need_table_output(const TableText& text) {
  need_extension(text.out, {".csv"}, "a table is");
  need_unread(text.out, text.results);
  need_folder_of(text.out);
  if (is_of_result(text.out))
    throw std::runtime_error(text.out.string() + ": is a file of a result: choose another -o");
}

int table(Program& program, const TableText& text) {
  need_table_output(text);
  std::string written = long_header();
  CohortTable columns;
  std::vector<std::string> labels;
  std::size_t count = 0;
  std::vector<std::string> failures, findings;
  for (const fs::path& result : text.results) {
    const bool is_folder = fs::is_directory(result);
    const fs::path file = is_folder ? result / "result.json" : result;
    const fs::path folder =
        is_folder ? fs::absolute(result).lexically_normal() : fs::absolute(file).parent_path();
    const std::string name =
        folder.filename().empty() ? folder.parent_path().filename().string() : folder.filename().string();
    const Json read = read_result(file);
    const std::vector<ResultRow> rows = rows_of(read, name);
    const ScanAudits audits = scan_audits_of(read);
    for (const std::string& finding : audits.findings)
      (audits.fails() ? failures : findings).push_back(name + ": " + finding);
    count += rows.size();
    for (const ResultRow& row : rows) written += long_line(row);
    columns.add(static_cast<std::uint32_t>(labels.size()), rows);
    labels.push_back(name);
  }
  voxel::write_whole(text.out, text.wide ? wide_table(labels, columns) : written);
  Json json = answer({});
  json["path"] = text.out.string();
  json["results"] = labels.size();
  json["numbers"] = count;
  // Inputs that failed come first, because only the first findings of a run are printed.
  findings.insert(findings.begin(), failures.begin(), failures.end());
  for (const std::string& finding : findings) warn_finding(finding);
  json["findings"] = std::move(findings);
  program.say(json, std::to_string(count) + " numbers of " + std::to_string(labels.size()) +
                        " results\nwritten: " + text.out.string() + "\n");
  return done;
}

}  // namespace

void add_cohort(Program& program) {
  const auto text = std::make_shared<CohortText>();
  CLI::App& verb =
      program.verb("cohort", "Runs one plan on the scans of many subjects, then writes the group's tables",
                   "octotomy cohort scans.csv out participant --plan le_fort_i.plan.json",
                   [&program, text] { return cohort(program, *text); });
  verb.add_option("in", text->in, "A BIDS folder, or a .csv with the columns participant_id and scan")
      ->required()
      ->check(CLI::ExistingPath);
  verb.add_option("out", text->out, "The derivatives' folder: sub-LABEL for each subject, and group")
      ->required();
  verb.add_option("level", text->level, "participant: evaluates; group: merges")
      ->required()
      ->check(CLI::IsMember({"participant", "group"}));
  verb.add_option("--plan", text->plan, "The plan to run on every subject's scans")->check(CLI::ExistingFile);
  verb.add_option("--participant-label", text->labels, "Only these subjects, with or without 'sub-'");
  verb.add_option("--engine", text->engine, "serial, parallel (GNU parallel) or slurm")
      ->check(CLI::IsMember({"serial", "parallel", "slurm"}));
  verb.add_option("--jobs", text->jobs,
                  "Number of processes at a time with --engine parallel; with --dry-run, the number that the "
                  "partition runs")
      ->check(CLI::Range(1, 100000));
  verb.add_option("--slurm", text->slurm, "Options for sbatch, such as --slurm=--mem=8G");
  verb.add_flag("--again", text->again, "Also evaluates subjects that are done");
  verb.add_flag("--reports", text->reports, "Writes each subject's report and files as well");
  verb.add_flag("--dry-run", text->dry_run,
                "Only estimates time and memory, from the subjects that are done");
  verb.add_option("--against", text->against,
                  "For group: the same cohort by another observer, to compare both")
      ->check(CLI::ExistingDirectory);

  const auto of = std::make_shared<TableText>();
  CLI::App& table_verb = program.verb(
      "table", "Writes the measurements of many results as a table, one row each",
      "octotomy table report_1 report_2 -o measurements.csv", [&program, of] { return table(program, *of); });
  table_verb.add_option("results", of->results, "Results' folders, or result.json files")
      ->required()
      ->check(CLI::ExistingPath);
  table_verb.add_option("-o,--out", of->out, "A .csv")->required();
  table_verb.add_flag("--wide", of->wide,
                      "One row per result and one column per number, instead of one row per number");
}

}  // namespace octotomy::planner::cli
