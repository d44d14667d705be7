// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cstdio>

#include "planner/answer.h"
#include "planner/cli/scan_in.h"
#include "planner/figures.h"
#include "planner/nearest_name.h"
#include "planner/report.h"

namespace octotomy::planner::cli {
namespace {

struct PlanText {
  std::filesystem::path plan;
  std::filesystem::path out;
  std::vector<std::string> scans;
  ScanIn in;
};

/// Reads the plan and puts NAME=PATH in the place of its scans' paths; those are relative to where we are.
Plan plan_of(const Program& program, const PlanText& text) {
  Plan plan = read_plan(text.plan);
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
    found->second.path = std::filesystem::absolute(scan.substr(equals + 1)).lexically_normal();
  }
  if (const voxel::ReadOptions read = read_options(program, text.in);
      !read.series.empty() || read.spacing_mm || read.raw) {
    if (plan.scans.size() != 1)
      throw std::runtime_error(
          "--series, --spacing and --raw are of one scan, the plan has several: say series, spacing_mm or "
          "raw beside their paths in the plan");
    plan.scans.begin()->second.read = read;
  }
  return plan;
}

std::string verdict_text(const Evaluation& evaluation) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const Object& object : evaluation.objects) {
    std::string line = "no certificate";
    if (object.certificate) {
      const verify::Certificate& c = *object.certificate;
      line = verify::to_string(c.agreement) + "  voxel " + grouped(c.voxel.volume_mm3, 1) + ", mesh " +
             grouped(c.mesh.volume_mm3, 1) + " mm\u00b3, difference " + grouped(c.difference_mm3, 1) +
             " of " + grouped(c.tolerance_mm3, 1) + " allowed";
      for (const std::string& reason : c.reasons) line += "; " + reason;
    }
    if (object.kind != "mask" || object.certificate) rows.emplace_back(object.id, line);
    for (const std::string& finding : object.findings) warn(object.id + ": " + finding);
  }
  return lines(rows);
}

int status_of(const Evaluation& evaluation) {
  if (verdict_counts(evaluation).fail > 0) {
    warn("the kernels disagree (a FAIL verdict)");
    return disagreement;
  }
  return done;
}

EvaluateOptions options_of(Program& program) {
  return {program.stop.get_token(), program.progress(), true};
}

int run(Program& program, const PlanText& text) {
  Result result;
  result.plan = plan_of(program, text);
  result.evaluation = evaluate(result.plan, options_of(program));
  result.pictures = plan_pictures(result.plan, result.evaluation);
  if (program.stop.stop_requested()) throw Stopped("stopped before the result was written");
  const Json json = write_result(result, text.out);
  std::string measured = verdict_text(result.evaluation);
  for (const Exported& exported : result.exported)
    for (const std::string& finding : exported.findings) warn(exported.path + ": " + finding);
  program.say(json, measured + "written: " + (text.out / "report.html").string() + "\n");
  return status_of(result.evaluation);
}

int verify_plan(Program& program, const PlanText& text) {
  Result result;
  result.plan = plan_of(program, text);
  result.evaluation = evaluate(result.plan, options_of(program));
  const Json whole = result_json(result);
  Json json = answer(result.evaluation.timings);
  json["certificates"] = whole["certificates"];
  json["counts"] = whole["counts"];
  program.say(json, verdict_text(result.evaluation));
  return status_of(result.evaluation);
}

void add_plan_options(CLI::App& verb, PlanText& text) {
  verb.add_option("plan", text.plan, "A .plan.json")->required()->check(CLI::ExistingFile);
  verb.add_option("--scan", text.scans, "NAME=PATH: reads the plan's scan NAME from PATH")
      ->type_name("NAME=PATH");
  add_scan_options(verb, text.in);
}

}  // namespace

void add_plan_verbs(Program& program) {
  const auto to_run = std::make_shared<PlanText>();
  CLI::App& run_verb =
      program.verb("run", "Replays a plan and writes result.json, report.html, pictures and exports",
                   "octotomy run planner/le_fort_i.plan.json --scan ct=head.nrrd -o report",
                   [&program, to_run] { return run(program, *to_run); });
  add_plan_options(run_verb, *to_run);
  run_verb.add_option("-o,--out", to_run->out, "The result's folder: new, empty, or an earlier result")
      ->required();

  const auto to_verify = std::make_shared<PlanText>();
  CLI::App& verify_verb =
      program.verb("verify", "Replays a plan for its certificates only; nothing is written",
                   "octotomy verify planner/le_fort_i.plan.json --scan ct=head.nrrd --json",
                   [&program, to_verify] { return verify_plan(program, *to_verify); });
  add_plan_options(verify_verb, *to_verify);
}

}  // namespace octotomy::planner::cli
