// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/numbers.h"
#include "planner/cli/verb/plan_in.h"
#include "planner/cli/verb/scan_in.h"
#include "planner/operation/file/landmarks_file.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/number_format.h"
#include "planner/plan/rebase.h"
#include "planner/procedure/template/chain.h"
#include "planner/procedure/template/procedure.h"
#include "voxel/space/staged_files.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct ProcedureText {
  std::string name;
  fs::path scan, donor, after, out, report;
  Certify certify = Certify::Now;
  std::vector<fs::path> landmarks;
  std::vector<std::string> values, options;
  double voxel_mm = 1.0;
  bool anonymous = false;
};

Json json_of(const std::vector<ProcedureValue>& values,
             std::vector<std::pair<std::string, std::string>>& rows) {
  Json json = Json::array();
  for (const ProcedureValue& value : values) {
    json.push_back({{"name", value.name},
                    {"says", value.says},
                    {"preset", value.preset},
                    {"least", value.least},
                    {"most", value.most}});
    rows.emplace_back("--set " + value.name + "=" + plain(value.preset), value.says);
  }
  return json;
}

/// Prints the inputs of a procedure, or the names of all procedures if none is named. Returns the exit
/// status.
int explain(const Program& program, const ProcedureText& text) {
  Json json = answer({});
  if (text.name.empty()) {
    std::vector<std::pair<std::string, std::string>> rows;
    json["procedures"] = Json::array();
    for (const std::string& name : procedures()) {
      const Procedure procedure = read_procedure(name);
      json["procedures"].push_back({{"name", name}, {"says", procedure.says}});
      rows.emplace_back(name, procedure.says);
    }
    program.say(json, lines(rows));
    return done;
  }
  const Procedure procedure = read_procedure(text.name);
  json["name"] = procedure.name;
  json["says"] = procedure.says;
  json["landmarks"] = Json::array();
  std::vector<std::pair<std::string, std::string>> rows;
  for (const ProcedureLandmark& landmark : procedure.landmarks) {
    json["landmarks"].push_back({{"name", landmark.name}, {"says", landmark.says}});
    rows.emplace_back(landmark.name, landmark.says);
  }
  for (const ProcedureScan& scan : procedure.scans) {
    json["scans"].push_back({{"name", scan.name}, {"says", scan.says}});
    rows.emplace_back("--" + scan.name, scan.says);
  }
  json["values"] = json_of(procedure.values, rows);
  json["options"] = Json::array();
  for (const ProcedureOption& option : procedure.options) {
    rows.emplace_back("--with " + option.name, option.says);
    json["options"].push_back(
        {{"name", option.name}, {"says", option.says}, {"values", json_of(option.values, rows)}});
  }
  program.say(json, procedure.says + "\n" + lines(rows));
  return done;
}

ProcedureInput input_of(const ProcedureText& text) {
  if ((text.after.empty() && (text.scan.empty() || text.landmarks.empty())) || text.out.empty())
    throw std::runtime_error(
        "to plan it, give --scan, --landmarks and -o, or --after PLAN and -o; without options the verb "
        "explains the procedure");
  std::vector<fs::path> inputs = text.landmarks;
  inputs.push_back(text.name);
  if (!text.after.empty()) inputs.push_back(text.after);
  need_extension(text.out, {".json"}, "a plan is");
  need_unread(text.out, inputs);
  need_folder_of(text.out);
  ProcedureInput input;
  const auto entry = [](const fs::path& path) { return Json{{"path", voxel::absolute_of(path).string()}}; };
  if (!text.scan.empty()) input.scan = entry(text.scan);
  if (!text.donor.empty()) input.further_scans["donor"] = entry(text.donor);
  for (const fs::path& path : text.landmarks) {
    const std::vector<brep::Landmark> read = read_landmarks(path);
    input.landmarks.insert(input.landmarks.end(), read.begin(), read.end());
  }
  input.voxel_mm = text.voxel_mm;
  input.folder = fs::absolute(text.out).parent_path();
  for (const std::string& value : text.values) {
    const auto equals = value.find('=');
    char* end = nullptr;
    const double number = equals == std::string::npos ? 0.0 : std::strtod(value.c_str() + equals + 1, &end);
    if (equals == std::string::npos || *end != '\0' || end == value.c_str() + equals + 1)
      throw std::runtime_error("--set '" + value + "' must be NAME=NUMBER, for example forward_mm=6");
    input.values[value.substr(0, equals)] = number;
  }
  return input;
}

/// The plan of a procedure, alone or after the plan of --after. Sets `carried` to the landmarks that lie on a
/// moved piece and move with it.
Json planned(Program& program, const ProcedureText& text, std::vector<std::string>& carried) {
  const Procedure procedure = with_options(read_procedure(text.name), text.options);
  const ProcedureInput input = input_of(text);
  if (text.after.empty()) return plan_of(procedure, input);
  const Plan before = rebased(read_plan(text.after), input.folder);
  EvaluateOptions options = evaluate_options(program);
  options.certify = options.meshes = false;
  if (const std::optional<std::string> outcome = outcome_of(before)) options.wanted = {*outcome};
  Chained made = chained(before, evaluated(program, before, options), procedure, input);
  carried = std::move(made.carried);
  return made.plan;
}

int procedure(Program& program, const ProcedureText& text) {
  if (text.scan.empty() && text.landmarks.empty() && text.out.empty() && text.after.empty())
    return explain(program, text);
  if (text.name.empty()) throw std::runtime_error("name the procedure: octotomy procedure lists them");
  std::vector<std::string> carried;
  const Json plan = planned(program, text, carried);
  const std::string written = plan.dump(2) + "\n";
  const auto write = [&] { voxel::write_whole(text.out, written); };
  if (!text.report.empty()) {
    RunText replay;
    replay.out = text.report;
    replay.certify = text.certify;
    replay.anonymous = text.anonymous;
    Plan read = parse_plan(written, fs::absolute(text.out).parent_path());
    read.file = text.out;
    return run(program, replay, std::move(read), write);
  }
  write();
  Json json = answer({});
  json["path"] = text.out.string();
  json["plan"] = plan;
  std::string lines_of_landmarks;
  if (!text.after.empty()) json["carried_landmarks"] = carried;
  for (const std::string& name : carried)
    lines_of_landmarks += "landmark " + name + ": lies on a piece that has moved, and moves with it\n";
  program.say(json, lines_of_landmarks + "written: " + text.out.string() + "; octotomy run " +
                        text.out.string() + " -o FOLDER\n");
  return done;
}

}  // namespace

void add_procedure(Program& program) {
  const auto text = std::make_shared<ProcedureText>();
  CLI::App& verb = program.verb(
      "procedure",
      "Plans an operation by its name, from landmarks and a few values; without a name it lists all "
      "procedures",
      "octotomy procedure le_fort_i\n"
      "  octotomy procedure le_fort_i --scan head.nrrd --landmarks marks.mrk.json --set forward_mm=6 "
      "--set up_mm=2 -o my.plan.json\n"
      "  octotomy procedure fibula_flap --scan head.nrrd --landmarks jaw.json --donor leg.nrrd "
      "--landmarks leg.json --with guides -o flap.plan.json\n"
      "  octotomy procedure genioplasty --after my.plan.json --landmarks chin.json --set forward_mm=4 "
      "-o both.plan.json",
      [&program, text] { return procedure(program, *text); });
  verb.add_option("name", text->name, "The procedure, or a .json file of one");
  verb.add_option("--scan", text->scan, "The scan")->check(scan_path());
  verb.add_option("--donor", text->donor, "For a flap: the scan of the donor bone")->check(scan_path());
  verb.add_option("--after", text->after,
                  "An earlier plan: the procedure acts on its step 'planned' or 'rebuilt', and its landmarks "
                  "move with the pieces on which they lie")
      ->check(CLI::ExistingFile)
      ->excludes("--scan");
  verb.add_option("--landmarks", text->landmarks,
                  "Named points: JSON, or 3D Slicer's .mrk.json or .fcsv; may be repeated, one file per scan")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false)
      ->check(CLI::ExistingFile);
  verb.add_option("--set", text->values, "NAME=NUMBER: a value of the procedure; may be repeated")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("NAME=NUMBER");
  verb.add_option(
          "--with", text->options,
          "An option of the procedure: further steps, such as guides for a flap's cuts and a plate; may be "
          "repeated")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false)
      ->type_name("OPTION");
  verb.add_option("--voxel", text->voxel_mm, "Edge of the plan's voxels, mm; default 1")
      ->check(above_zero())
      ->excludes("--after");
  verb.add_option("-o,--out", text->out, "The .plan.json, which stands alone and may be edited");
  verb.add_option("--report", text->report, "Replays the plan into this folder at once, as run does");
  add_certify(verb, text->certify);
  add_anonymous(verb, text->anonymous);
  verb.get_option("--anonymous")->needs("--report");
}

}  // namespace octotomy::planner::cli
