// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <map>

#include "planner/cli/suite/suites.h"
#include "verify/suite/manipulation_study.h"
#include "verify/suite/representation_study.h"
#include "verify/suite/thesis_tables.h"

namespace octotomy::planner::cli {
namespace {

SuiteAnswer run_thesis(Program&, const VerifyText&) {
  SuiteAnswer answer;
  std::vector<verify::ThesisEntry> entries;
  {
    const Stopwatch watch(answer.timings, "thesis");
    entries = verify::thesis_tables();
  }
  verify::RepresentationStudy study;
  {
    const Stopwatch watch(answer.timings, "study");
    study = verify::representation_study();
    const verify::RepresentationStudy more = verify::manipulation_study();
    study.entries.insert(study.entries.end(), more.entries.begin(), more.entries.end());
    study.beside.insert(study.beside.end(), more.beside.begin(), more.beside.end());
  }
  entries.insert(entries.end(), study.entries.begin(), study.entries.end());
  Json tables = Json::array(), beside = Json::array(), gaps = Json::array();
  std::vector<std::string> order;
  std::map<std::string, std::pair<int, int>> agreeing;  // of entries
  std::vector<std::pair<std::string, std::string>> differing;
  for (const verify::ThesisEntry& entry : entries) {
    tables.push_back({{"where", entry.where},
                      {"item", entry.item},
                      {"printed", entry.printed},
                      {"ours", entry.ours},
                      {"agrees", entry.agrees()},
                      {"note", entry.note.empty() ? Json(nullptr) : Json(entry.note)}});
    if (!agreeing.contains(entry.where)) order.push_back(entry.where);
    auto& [same, all] = agreeing[entry.where];
    same += entry.agrees();
    ++all;
    if (entry.agrees()) continue;
    answer.held = false;
    differing.emplace_back(entry.where, entry.item + ": printed " + entry.printed + ", ours " + entry.ours);
  }
  std::vector<std::pair<std::string, std::string>> rows;
  for (const std::string& where : order)
    rows.emplace_back(where, std::to_string(agreeing[where].first) + " of " +
                                 std::to_string(agreeing[where].second) + " as printed");
  rows.insert(rows.end(), differing.begin(), differing.end());
  for (const verify::ThesisComparison& one : study.beside) {
    beside.push_back(
        {{"where", one.where}, {"item", one.item}, {"printed", one.printed}, {"ours", one.ours}});
    rows.emplace_back(one.where, one.item + ": printed " + one.printed + "; ours " + one.ours);
  }
  for (const verify::ThesisGap& gap : verify::thesis_gaps()) {
    gaps.push_back({{"where", gap.where}, {"why", gap.why}});
    rows.emplace_back(gap.where, "not recomputed: " + gap.why);
  }
  answer.more = {{"tables", tables}, {"beside", beside}, {"not_recomputed", gaps}};
  answer.text = lines(rows);
  return answer;
}

CLI::Option* add_thesis(CLI::App& verb, VerifyText& text) {
  return verb.add_flag("--thesis", text.thesis,
                       "A suite: compares the thesis's tables and worked examples with computed ones; rows "
                       "that depend on its patient's scan are shown beside those of the head phantom");
}

}  // namespace

const Suite thesis_suite{add_thesis, run_thesis};

}  // namespace octotomy::planner::cli
