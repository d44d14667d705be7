// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/plan_in.h"
#include "planner/report/report.h"
#include "planner/report/result_folder.h"

namespace octotomy::planner::cli {
namespace {

struct RunText : PlanIn {
  std::filesystem::path out;
};

int run(Program& program, const RunText& text) {
  Result result;
  result.plan = plan_of(program, text);
  need_result_folder(text.out, result_names(result.plan));
  result.evaluation = evaluated(program, result.plan);
  result.pictures = plan_pictures(result.plan, result.evaluation);
  if (program.stop.stop_requested()) throw Stopped("stopped before the result was written");
  const Json json = write_result(result, text.out, {program.stop.get_token(), program.progress()});
  std::string measured = verdict_text(result.evaluation);
  for (const Exported& exported : result.exported)
    for (const std::string& finding : exported.findings) warn(exported.path + ": " + finding);
  program.say(json, measured + "written: " + (text.out / "report.html").string() + "\n");
  return status_of(result.evaluation);
}

}  // namespace

void add_plan_verbs(Program& program) {
  program.verb("schema", "The JSON schema of plans, from the table of operations",
               "octotomy schema > plan.schema.json", [&program] {
                 const std::string text = plan_schema().dump(2) + "\n";
                 program.say(plan_schema(), text);
                 return static_cast<int>(done);
               });
  const auto text = std::make_shared<RunText>();
  CLI::App& verb =
      program.verb("run", "Replays a plan and writes result.json, report.html, pictures and exports",
                   "octotomy run planner/le_fort_i.plan.json --scan ct=head.nrrd -o report",
                   [&program, text] { return run(program, *text); });
  verb.add_option("plan", text->plan, "A .plan.json")->required()->check(CLI::ExistingFile);
  add_plan_options(verb, *text);
  verb.add_option("-o,--out", text->out,
                  "The result's folder: new, empty, or an earlier result; files that you put there stay")
      ->required();
}

}  // namespace octotomy::planner::cli
