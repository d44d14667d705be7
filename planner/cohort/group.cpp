// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cohort/group.h"

#include <algorithm>
#include <fstream>
#include <map>

#include "planner/cohort/participant.h"
#include "planner/cohort/plots.h"
#include "planner/cohort/statistics.h"
#include "planner/operation/table/csv.h"
#include "planner/operation/table/json.h"
#include "planner/result/report/drawn_page.h"
#include "planner/result/report/result_folder.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// The rows of a subject that has an answer, read from its rows.csv.
std::vector<ResultRow> rows_in(const fs::path& out, const Subject& subject) {
  const fs::path path = out / subject.folder() / "rows.csv";
  try {
    return parse_long_table(voxel::file_bytes(path));
  } catch (const voxel::Error& error) {
    throw voxel::Error(error.code(), path.string() + ": " + error.what() + ": evaluate the subject again");
  }
}

/// Collects findings of the subjects' audits for the whole cohort. Lists every finding of subjects with a
/// FAIL. Of the others' WARNs it lists one for each check, with the number of further ones, because a fault
/// of the exporting program occurs in many subjects.
class AuditFindings {
 public:
  void add(const std::string& label, const SubjectRecord& record) {
    for (const std::string& finding : record.audit_findings) {
      if (record.state == SubjectRecord::State::Doubtful) {
        failures_.push_back(label + ": " + finding);
        continue;
      }
      Warned& warned = warnings_[finding.substr(0, finding.find(": ", finding.find("WARN, ")))];
      if (warned.count++ == 0) warned.first = label + ": " + finding;
    }
  }
  void append_to(Json& findings) const {
    for (const std::string& failure : failures_) findings.push_back(failure);
    for (const auto& [check, warned] : warnings_)
      findings.push_back(warned.first + (warned.count == 1
                                             ? ""
                                             : " (and " + check + " " + std::to_string(warned.count - 1) +
                                                   " times more: subjects.csv has all)"));
  }

 private:
  struct Warned {
    std::size_t count = 0;
    std::string first;
  };
  std::vector<std::string> failures_;
  std::map<std::string, Warned> warnings_;
};

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "; ") + line;
  return text;
}

/// For each subject with both, the values of the two kernels in a column: first voxel, then mesh.
std::vector<std::pair<double, double>> of_kernels(const CohortColumn& column) {
  std::vector<std::pair<double, double>> answers;
  for (const CohortValue& value : column.values)
    if (value.voxel && value.mesh) answers.emplace_back(*value.voxel, *value.mesh);
  return answers;
}

/// For each subject that both observers have, this observer's number and then the other's.
std::vector<std::pair<double, double>> of_observers(const CohortColumn& column, const CohortTable& other) {
  std::map<std::uint32_t, double> others;
  for (const CohortColumn& its : other.columns())
    if (its.name() == column.name() && its.unit == column.unit)
      for (const CohortValue& value : its.values) others[value.subject] = value.value;
  std::vector<std::pair<double, double>> answers;
  for (const CohortValue& value : column.values)
    if (const auto found = others.find(value.subject); found != others.end())
      answers.emplace_back(value.value, found->second);
  return answers;
}

Json agreement_json(const Agreement& agreement) {
  return {{"pairs", agreement.points.size()},
          {"bias", agreement.bias},
          {"limits_of_agreement", {agreement.low, agreement.high}}};
}

/// A unit as the page shows it, such as "mm³" for "mm3".
std::string shown_unit(const std::string& unit) {
  if (unit == "mm3") return "mm³";
  return unit == "mm2" ? "mm²" : unit;
}

/// One number over a cohort, with its summary and plots.
struct GroupColumn {
  std::string name, unit;
  Json summary;
  std::vector<std::pair<std::string, std::string>> plots;  ///< kind of each plot, and its SVG
};

Json to_json(const GroupColumn& column) {
  Json plots = Json::array();
  for (const auto& [kind, svg] : column.plots) plots.push_back(svg);
  return {{"name", column.name}, {"unit", column.unit}, {"summary", column.summary}, {"plots", plots}};
}

/// Summarises a column: its statistics, its outliers and its plots.
GroupColumn summarised(const CohortColumn& column, const std::vector<Subject>& subjects,
                       const std::optional<CohortTable>& other) {
  const std::string unit = shown_unit(column.unit);
  GroupColumn made{column.name(), unit, {}, {}};
  std::vector<double> numbers, undoubted;
  Json doubtful = Json::array();
  for (const CohortValue& value : column.values) {
    numbers.push_back(value.value);
    if (value.is_doubtful)
      doubtful.push_back(subjects[value.subject].label);
    else
      undoubted.push_back(value.value);
  }
  const Spread spread = spread_of(numbers);
  made.plots.emplace_back("distribution", distribution_svg(column.name(), unit, numbers));
  Json outliers = Json::array();
  for (const CohortValue& value : column.values)
    if (value.value < spread.lower_fence || value.value > spread.upper_fence)
      outliers.push_back({{"subject", subjects[value.subject].label}, {"value", value.value}});
  made.summary = {{"measurement", column.measurement},
                  {"quantity", column.quantity},
                  {"unit", column.unit},
                  {"subjects", spread.count},
                  {"mean", spread.mean},
                  {"sd", spread.sd},
                  {"least", spread.least},
                  {"median", spread.median},
                  {"greatest", spread.greatest},
                  {"outliers", outliers},
                  {"doubtful", doubtful}};
  if (!doubtful.empty() && !undoubted.empty()) {
    const Spread without = spread_of(undoubted);
    made.summary["without_doubtful"] = {{"subjects", without.count}, {"mean", without.mean},
                                        {"sd", without.sd},          {"least", without.least},
                                        {"median", without.median},  {"greatest", without.greatest}};
  }
  const auto add = [&](const std::string& of, const std::string& title,
                       const std::vector<std::pair<double, double>>& answers) {
    if (answers.size() < 2) return;
    const Agreement agreement = agreement_of(answers);
    made.summary[of] = agreement_json(agreement);
    made.plots.emplace_back(of, agreement_svg(column.name() + ": " + title, unit, agreement));
  };
  add("kernels", "mesh less voxel kernel", of_kernels(column));
  if (other) add("observers", "other less this observer", of_observers(column, *other));
  return made;
}

/// Reports progress and throws if a stop is requested. Does so only for some of the subjects, because most
/// take little time.
void look_up(const GroupOptions& options, std::size_t subject, std::size_t count) {
  if (subject % 256 != 0) return;
  if (options.stop.stop_requested()) throw voxel::Stopped("stopped before the group was written");
  if (options.progress)
    options.progress("subjects", static_cast<double>(subject) / static_cast<double>(count));
}

}  // namespace

std::string wide_table(const std::vector<std::string>& labels, const CohortTable& table) {
  std::vector<std::string> header{"subject"};
  for (const CohortColumn& column : table.columns()) {
    const std::string name = column.name();
    for (const std::string& cell :
         {name + "_" + column.unit, name + "_half_width_" + column.unit, name + "_verdict"})
      header.push_back(cell);
  }
  std::string text = csv_line(header);
  std::vector<std::size_t> next(table.columns().size(), 0);
  for (std::uint32_t subject = 0; subject < labels.size(); ++subject) {
    std::vector<std::string> cells{labels[subject]};
    for (std::size_t i = 0; i < next.size(); ++i) {
      const std::vector<CohortValue>& values = table.columns()[i].values;
      const bool has = next[i] < values.size() && values[next[i]].subject == subject;
      if (!has) {
        cells.insert(cells.end(), 3, {});
        continue;
      }
      const CohortValue& value = values[next[i]++];
      cells.insert(cells.end(), {csv_number(value.value), csv_number(value.half_width), value.verdict});
    }
    text += csv_line(cells);
  }
  return text;
}

Json merge_group(const std::vector<Subject>& subjects, const fs::path& out, const GroupOptions& options) {
  need_result_folder(out / "group");
  ResultFolder folder(out / "group");
  fs::create_directories(folder.path() / "plots");
  std::ofstream rows_file(folder.path() / "measurements.csv", std::ios::binary);
  std::ofstream subjects_file(folder.path() / "subjects.csv", std::ios::binary);
  rows_file << long_header();
  subjects_file << csv_line({"subject", "state", "reason", "seconds", "peak_mb", "audit_findings"});
  CohortTable table;
  std::optional<CohortTable> other;
  if (options.against) other.emplace();
  std::vector<std::string> labels;
  Json shown = Json::array(), columns = Json::array();
  std::size_t done = 0, doubtful = 0, failed = 0;
  AuditFindings audits;
  Json findings = options.findings;
  for (std::uint32_t i = 0; i < subjects.size(); ++i) {
    const Subject& subject = subjects[i];
    look_up(options, i, subjects.size());
    const auto told_record = [&](const fs::path& cohort) {
      SubjectRecord record = subject_record(cohort, subject);
      if (record.state == SubjectRecord::State::Changed)
        findings.push_back(subject.label + ": " + record.reason);
      return record;
    };
    const SubjectRecord record = told_record(out);
    const bool has_answer = record.has_answer(), is_doubtful = record.state == SubjectRecord::State::Doubtful;
    ++(is_doubtful ? doubtful : has_answer ? done : failed);
    audits.add(subject.label, record);
    labels.push_back(subject.label);
    if (has_answer) {
      const std::vector<ResultRow> rows = rows_in(out, subject);
      for (const ResultRow& row : rows) rows_file << long_line(row);
      table.add(i, rows);
      if (const SubjectRecord others = other ? told_record(*options.against) : SubjectRecord{};
          others.has_answer()) {
        other->add(i, rows_in(*options.against, subject));
        if (others.audit_findings != record.audit_findings)
          audits.add(options.against->string() + ", " + subject.label, others);
      }
    }
    subjects_file << csv_line({subject.label, to_string(record.state), has_answer ? "" : record.reason,
                               csv_number(record.seconds), csv_number(record.peak_mb),
                               joined(record.audit_findings)});
    shown.push_back({{"label", subject.label},
                     {"reason", has_answer ? "" : record.reason},
                     {"has_picture", fs::exists(out / subject.folder() / "picture.png")},
                     {"is_doubtful", is_doubtful},
                     {"audit", is_doubtful ? joined(record.audit_findings) : ""}});
  }
  if (!rows_file.flush() || !subjects_file.flush())
    throw voxel::Error(voxel::ErrorCode::Resource,
                       folder.path().string() + ": cannot be written: the disk may be full");

  audits.append_to(findings);
  Json summary{{"octotomy", OCTOTOMY_VERSION}, {"subjects", subjects.size()}, {"done", done},
               {"doubtful", doubtful},         {"without_answer", failed},    {"findings", findings},
               {"measurements", Json::array()}};
  for (const CohortColumn& column : table.columns()) {
    const GroupColumn made = summarised(column, subjects, other);
    columns.push_back(to_json(made));
    summary["measurements"].push_back(made.summary);
    for (const auto& [kind, svg] : made.plots)
      voxel::write_file(folder.path() / "plots" / (column.name() + "_" + kind + ".svg"), svg);
  }
  voxel::write_file(folder.path() / "wide.csv", wide_table(labels, table));
  voxel::write_file(folder.path() / "summary.json", summary.dump(2) + "\n");
  voxel::write_file(
      folder.path() / "index.html",
      drawn_page("Cohort of " + std::to_string(subjects.size()) + " subjects",
                 {{"kind", "cohort"}, {"subjects", shown}, {"columns", columns}, {"findings", findings}},
                 "This page needs scripts. Without them, read summary.json, wide.csv and the folder 'plots' "
                 "in the folder of this page."));
  folder.publish();
  return summary;
}

}  // namespace octotomy::planner
