// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/verb/plan_in.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/report.h"
#include "voxel/space/staged_files.h"

namespace octotomy::planner::cli {

void add_scan_paths(CLI::App& verb, PlanIn& text) {
  verb.add_option("--scan", text.scans, "NAME=PATH: reads the plan's scan NAME from PATH")
      ->type_name("NAME=PATH");
}

void add_plan_options(CLI::App& verb, PlanIn& text) {
  add_scan_paths(verb, text);
  add_scan_options(verb, text.in);
}

Plan plan_of(const Program& program, const PlanIn& text) {
  return plan_of(program, text, read_plan(text.plan));
}

Plan plan_of(const Program& program, const PlanIn& text, Plan plan) {
  std::vector<std::string> names;
  for (const auto& [name, unused] : plan.scans) names.push_back(name);
  for (const std::string& scan : text.scans) {
    const auto equals = scan.find('=');
    if (equals == std::string::npos || equals + 1 == scan.size())
      throw std::runtime_error("--scan '" + scan + "' must be NAME=PATH, for example ct=head.nrrd");
    const std::string name = scan.substr(0, equals);
    const auto found = plan.scans.find(name);
    if (found == plan.scans.end())
      throw std::runtime_error("--scan: the plan has no scan called '" + name + "'" +
                               suggestion(name, names));
    found->second.path = voxel::absolute_of(scan.substr(equals + 1));
  }
  if (const voxel::ReadOptions read = read_options(program, text.in);
      !read.series.empty() || read.join || !read.slices.empty() || read.spacing_mm || read.raw ||
      read.frame || read.unit) {
    if (plan.scans.size() != 1)
      throw std::runtime_error(
          "--series, --join, --slices, --spacing, --raw, --frame and --unit apply to one scan, but the "
          "plan " +
          std::string(plan.scans.empty() ? "has none: leave them out"
                                         : "has several: write series, join, slices, spacing_mm, raw, frame "
                                           "or unit beside their paths in the plan"));
    plan.scans.begin()->second.read = read;
  }
  return plan;
}

EvaluateOptions evaluate_options(Program& program) {
  return {program.stop.get_token(), program.progress()};
}

Evaluation evaluated(Program& program, const Plan& plan, const EvaluateOptions& options) {
  Evaluation evaluation = evaluate(plan, options);
  for (const ScanRecord& scan : evaluation.scans) program.note_scan(scan);
  return evaluation;
}

std::string verdict_text(const Evaluation& evaluation) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const Object& object : evaluation.objects) {
    std::string line = "no certificate";
    if (object.certificate) {
      const verify::Certificate& c = *object.certificate;
      line = verify::verdict_text(c) + "  voxel " + grouped(c.voxel.volume_mm3, 1) +
             (object.mesh.within ? ", mesh " : ", witness ") + grouped(c.mesh.volume_mm3, 1) +
             " mm\u00b3, difference " + grouped(c.difference_mm3, 1) + " of " + grouped(c.tolerance_mm3, 1) +
             " allowed in total" + (c.limit ? ", each place judged by itself" : "");
      for (const std::string& reason : c.reasons) line += "; " + reason;
    }
    if (!object.is_tool || object.certificate) rows.emplace_back(object.id, line);
    for (const std::string& finding : object.findings) warn_finding(object.id + ": " + finding);
  }
  return lines(rows);
}

int status_of(const Result& result) {
  const bool is_disputed = verdict_counts(result.evaluation).fail > 0;
  if (is_disputed) warn("the kernels disagree (a FAIL verdict)");
  const MeasuredVerdicts measured = measured_verdicts(result.measurements);
  for (const std::string& failed : measured.failed) warn("a FAIL verdict of " + failed);
  return is_disputed || measured.fail > 0 ? disagreement : done;
}

}  // namespace octotomy::planner::cli
