// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/plan_in.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/pack/pack.h"
#include "planner/result/report/patient.h"

namespace octotomy::planner::cli {
namespace {

struct PackText : PlanIn {
  std::filesystem::path out;
  bool anonymous = false;
  bool no_dicom = false;
  std::string identity = "keep";
};

int pack(Program& program, const PackText& text) {
  if (text.out.extension() != ".zip") throw std::runtime_error(text.out.string() + ": a pack is a .zip file");
  need_folder_of(text.out);
  Result result;
  result.plan = plan_of(program, text);
  result.anonymous = text.anonymous || text.identity == "remove";
  EvaluateOptions options = evaluate_options(program);
  options.prepares_files = true;
  options.keep_scans = true;
  result.evaluation = evaluated(program, result.plan, options);
  result.pictures = plan_pictures(result.plan, result.evaluation);
  PackOptions packing{{program.stop.get_token(), program.progress()}, std::nullopt};
  if (!text.no_dicom) packing.objects_of = series_of(result);
  std::vector<std::string> changes;
  if (text.identity == "remove") changes = leave_out_names(result);
  Timings timings = result.evaluation.timings;
  Json manifest;
  {
    const Stopwatch watch(timings, "pack");
    manifest = write_pack(result, text.out, packing);
  }
  for (const Exported& exported : result.exported)
    for (const std::string& finding : exported.findings) warn_finding(exported.path + ": " + finding);
  if (manifest.contains("dicom"))
    for (const Json& finding : manifest["dicom"]["findings"]) warn_finding(finding.get<std::string>());
  const auto bytes = std::filesystem::file_size(text.out);
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["bytes"] = bytes;
  json["counts"] = counts_json(result);
  if (!changes.empty()) json["identity"] = {{"choice", text.identity}, {"changes", changes}};
  json.update(manifest);
  program.say(json, verdict_text(result.evaluation) +
                        lines({{"written", text.out.string()},
                               {"entries", grouped(static_cast<double>(manifest["files"].size()), 0)},
                               {"size", grouped(static_cast<double>(bytes) / 1e6, 1) + " MB"}}));
  return status_of(result);
}

}  // namespace

void add_pack(Program& program) {
  const auto text = std::make_shared<PackText>();
  CLI::App& verb = program.verb(
      "pack",
      "Replays a plan into one .zip that others can check: octotomy verify replays it, and check_pack.py "
      "computes its numbers without this program",
      "octotomy pack planner/le_fort_i.plan.json --scan ct=head.nrrd -o le_fort_i.zip",
      [&program, text] { return pack(program, *text); });
  verb.add_option("plan", text->plan, "A .plan.json")->required()->check(CLI::ExistingFile);
  add_plan_options(verb, *text);
  verb.add_option("-o,--out", text->out, "The .zip to write")->required();
  add_anonymous(verb, text->anonymous);
  add_result_identity(verb, text->identity);
  verb.add_flag(
      "--no-dicom", text->no_dicom,
      "Leaves out the DICOM objects: objects, contours, exported surfaces, plan and views. Default: they are "
      "in the pack if a scan of the plan is a DICOM series, whose patient and study they name (not with "
      "--anonymous or --identity remove)");
}

}  // namespace octotomy::planner::cli
