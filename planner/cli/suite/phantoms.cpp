// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>

#include "planner/cli/suite/suites.h"
#include "planner/operation/table/number_format.h"
#include "verify/suite/interval_suite.h"
#include "verify/suite/phantom_suite.h"

namespace octotomy::planner::cli {
namespace {

Json case_json(const verify::PhantomCase& one, const verify::Certificate& certificate) {
  Json json{{"solid", one.solid}, {"spacing", one.spacing}, {"sampling", one.sampling}, {"seed", one.seed}};
  json.update(to_json(certificate));
  return json;
}

Json study_json(const verify::PhantomSuite& suite) {
  Json json = Json::object();
  for (const char* key : {"tightness", "calibration", "convergence", "checks"}) json[key] = Json::array();
  for (const verify::Tightness& t : suite.tightness)
    json["tightness"].push_back({{"spacing", t.spacing},
                                 {"sampling", t.sampling},
                                 {"cases", t.cases},
                                 {"worst_share", t.worst_share},
                                 {"p99_share", t.p99_share}});
  for (const verify::Calibration& c : suite.calibrations)
    json["calibration"].push_back({{"constant", c.constant},
                                   {"in_use", c.in_use},
                                   {"needed_by_99_percent", c.p99},
                                   {"poses", c.poses},
                                   {"seeds", "odd seeds calibrate, even seeds make the cases"}});
  for (const verify::Convergence& c : suite.convergences)
    json["convergence"].push_back({{"quantity", c.quantity},
                                   {"radii_voxels", c.radii_voxels},
                                   {"errors_percent", c.errors_percent},
                                   {"order", c.order},
                                   {"least_order", c.least_order}});
  for (const verify::SuiteCheck& c : suite.checks)
    json["checks"].push_back(
        {{"statement", c.statement}, {"found", c.found}, {"limit", c.allowed}, {"held", c.held}});
  json["area_with_edges_percent"] = suite.area_with_edges_percent;
  return json;
}

/// Adds how often the recommended values' intervals contain the truth: a row for each kind of solid, and two
/// rows that must pass.
void add_intervals(const std::vector<verify::IntervalCoverage>& table,
                   std::vector<std::pair<std::string, std::string>>& rows, SuiteAnswer& answer) {
  Json json = Json::array();
  for (const verify::IntervalCoverage& row : table) {
    const bool all = row.group.empty();
    const double width = row.p99_share > 0.0 ? 1.0 / row.p99_share : 0.0;
    json.push_back({{"quantity", row.quantity},
                    {"group", all ? "all" : row.group},
                    {"spacing", all ? "all" : row.spacing},
                    {"sampling", all ? "all" : row.sampling},
                    {"solids", row.cases},
                    {"held_percent", std::min(100.0, 100.0 * row.held)},
                    {"width_over_p99_error", width},
                    {"bias_percent", row.bias_percent},
                    {"p99_error_percent", row.p99_error_percent}});
    const std::string found = three_figures(100.0 * row.held) + " % held, width " + three_figures(width) +
                              " times the 99th percentile, error up to " +
                              three_figures(row.p99_error_percent) + " %, " + std::to_string(row.cases) +
                              " solids";
    if (!all) {
      rows.emplace_back(row.quantity + ", " + row.group + ", " + row.spacing + ", " + row.sampling, found);
      continue;
    }
    const bool held = row.held >= verify::least_held && row.p99_share >= verify::least_p99_share;
    answer.held = answer.held && held;
    rows.emplace_back(held ? "holds" : "DOES NOT HOLD", "interval of the " + row.quantity + " claimed at " +
                                                            three_figures(100.0 * verify::claimed_coverage) +
                                                            " %: " + found);
  }
  answer.more["intervals"] = std::move(json);
}

/// Adds rows for random solids, one for each class; classes that were not used for calibration are marked.
/// Every row must pass.
void add_drawn(const std::vector<verify::IntervalCoverage>& table,
               std::vector<std::pair<std::string, std::string>>& rows, SuiteAnswer& answer) {
  Json json = Json::array();
  for (const verify::IntervalCoverage& row : table) {
    const bool all = row.group.empty();
    const double width = row.p99_share > 0.0 ? 1.0 / row.p99_share : 0.0;
    json.push_back({{"quantity", row.quantity},
                    {"class", all ? "all" : row.group},
                    {"calibration", row.sampling},
                    {"solids", row.cases},
                    {"held_percent", std::min(100.0, 100.0 * row.held)},
                    {"median_width_percent", row.median_width_percent},
                    {"width_over_p99_error", width},
                    {"bias_percent", row.bias_percent},
                    {"p99_error_percent", row.p99_error_percent}});
    const std::string found = three_figures(100.0 * row.held) + " % held, median half-width " +
                              three_figures(row.median_width_percent) + " %, width " + three_figures(width) +
                              " times the 99th percentile, " + std::to_string(row.cases) + " solids";
    const double least = all ? verify::least_held : verify::least_held_of_a_class;
    const bool held = verify::is_likely(row, least);
    answer.held = answer.held && held;
    const std::string subject =
        row.quantity + " of drawn solids, " + (all ? "all classes" : row.group) + ", " + row.sampling;
    if (all || !held)
      rows.emplace_back(held ? "holds" : "DOES NOT HOLD",
                        "interval of the " + subject + ", at least " + three_figures(100.0 * least) +
                            " %, allowing for the chance in this number of solids: " + found);
    else
      rows.emplace_back(subject, found);
  }
  answer.more["drawn_intervals"] = std::move(json);
}

SuiteAnswer run_phantoms(Program& program, const VerifyText& text) {
  SuiteAnswer answer;
  verify::PhantomSuiteOptions options;
  options.poses = text.poses;
  options.progress = {program.stop.get_token(), program.progress("phantoms")};
  verify::PhantomSuite suite;
  {
    const Stopwatch watch(answer.timings, "phantoms");
    suite = verify::phantom_suite(options);
  }
  std::vector<std::pair<std::string, std::string>> rows;
  for (const verify::PhantomCase& one : suite.cases)
    for (const verify::Certificate* certificate : {&one.bounded, &one.closed_form}) {
      add(answer.counts, *certificate);
      answer.certificates.push_back(case_json(one, *certificate));
      if (certificate->verdict != verify::Verdict::Fail) continue;
      for (const std::string& reason : certificate->reasons)
        rows.emplace_back("FAIL", certificate->operation + ": " + reason);
    }
  for (const verify::Tightness& t : suite.tightness)
    rows.emplace_back(t.spacing + ", " + t.sampling,
                      std::to_string(t.cases) + " cases: observed up to " + three_figures(t.worst_share) +
                          " of the tolerance, 99th percentile " + three_figures(t.p99_share));
  for (const verify::SuiteCheck& check : suite.checks) {
    answer.held = answer.held && check.held;
    rows.emplace_back(
        check.held ? "holds" : "DOES NOT HOLD",
        check.statement + ": " + three_figures(check.found) + ", limit " + three_figures(check.allowed));
  }
  std::vector<verify::IntervalCoverage> intervals, drawn;
  {
    const Stopwatch watch(answer.timings, "intervals");
    intervals =
        verify::interval_suite({text.solids, 1, {program.stop.get_token(), program.progress("intervals")}});
    drawn = verify::drawn_suite(
        {std::max(text.solids / 4, 27), 1, {program.stop.get_token(), program.progress("drawn solids")}, {}});
  }
  rows.emplace_back("verdicts", text_of(answer.counts));
  answer.worst = std::move(suite.worst);
  answer.more = study_json(suite);
  add_intervals(intervals, rows, answer);
  add_drawn(drawn, rows, answer);
  answer.text = lines(rows);
  return answer;
}

CLI::Option* add_phantoms(CLI::App& verb, VerifyText& text) {
  verb.add_option("--poses", text.poses,
                  "For --phantoms: number of poses for each solid, spacing and sampling; default 6")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  verb.add_option("--solids", text.solids,
                  "For --phantoms: number of solids whose intervals of volume and area are compared with the "
                  "truth; default 400")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  return verb.add_flag("--phantoms", text.phantoms,
                       "Both kernels on solids with known volume and area, in all samplings");
}

}  // namespace

const Suite phantoms_suite{add_phantoms, run_phantoms};

}  // namespace octotomy::planner::cli
