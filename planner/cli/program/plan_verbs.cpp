// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <utility>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/plan_in.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/patient.h"
#include "planner/result/report/pdf.h"
#include "planner/result/report/preview.h"
#include "planner/result/report/report.h"
#include "planner/result/report/result_folder.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/disk_need.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner::cli {
namespace {

struct PreviewText : PlanIn {
  std::string step;
  std::filesystem::path out;
  PreviewOptions options;
};

int preview_step(Program& program, PreviewText& text) {
  for (const std::string& view : text.options.views) voxel::parse_view(view);
  if (text.out.extension() != ".png")
    throw std::runtime_error(text.out.string() + ": a preview is a .png file");
  need_folder_of(text.out);
  text.options.evaluation = evaluate_options(program);
  Preview made = preview(plan_of(program, text), text.step, text.options);
  for (const ScanRecord& scan : made.evaluation.scans) program.note_scan(scan);
  {
    const Stopwatch watch(made.evaluation.timings, "write");
    voxel::write_whole(text.out, {made.png.begin(), made.png.end()});
  }
  Json json = answer(made.evaluation.timings);
  json["path"] = text.out.string();
  json["step"] = text.step;
  json["views"] = Json::array();
  for (const ScenePicture& frame : made.frames)
    json["views"].push_back({{"view", frame.view},
                             {"centre_mm", {frame.centre_mm.x, frame.centre_mm.y}},
                             {"width_mm", frame.width_mm},
                             {"size_px", frame.size_px}});
  json["objects"] = Json::array();
  std::vector<std::pair<std::string, std::string>> rows;
  for (const Object& object : made.evaluation.objects) {
    json["objects"].push_back(
        {{"id", object.id}, {"volume_mm3", object.voxel.measures.volume_mm3}, {"findings", object.findings}});
    rows.emplace_back(object.id, grouped(object.voxel.measures.volume_mm3, 0) + " mm\u00b3");
    for (const std::string& finding : object.findings) warn_finding(object.id + ": " + finding);
  }
  rows.emplace_back("written", text.out.string());
  program.say(json, lines(rows));
  return done;
}

/// Writes the result's folder. Returns the contents of its result.json.
Json written(Program& program, Result& result, const std::filesystem::path& out) {
  if (program.stop.stop_requested()) throw Stopped("stopped before the result was written");
  return write_result(result, out, {program.stop.get_token(), program.progress()});
}

/// Refuses a plan if the disk has no room for one of its label maps. Checks this when the first scan is read,
/// because its lattice determines the size of the maps. Requires room only for the largest map, because the
/// others may compress to almost nothing.
void need_disk_of_label_maps(const Plan& plan, const std::filesystem::path& out, EvaluateOptions& options) {
  const auto is_first = std::make_shared<bool>(true);
  options.read_scene = [&plan, out, is_first](const std::filesystem::path& path,
                                              const voxel::ReadOptions& how) {
    voxel::Scene scene = voxel::read_scene(path, how);
    if (!std::exchange(*is_first, false)) return scene;
    const voxel::Lattice lattice = universe_of(scene, plan.voxel_mm).lattice();
    std::uint64_t least_bytes = 0;
    for (const Step& step : plan.steps)
      if (step.action.operation().name == "label_map")
        least_bytes = std::max(
            least_bytes, voxel::least_file_bytes(lattice, sizeof(std::int16_t), path_written(step.action)));
    voxel::need_disk(out, least_bytes);
    return scene;
  };
}

}  // namespace

int run(Program& program, const RunText& text) {
  return run(program, text, plan_of(program, text));
}

int run(Program& program, const RunText& text, Plan plan, const std::function<void()>& beside) {
  Result result;
  result.plan = std::move(plan);
  result.as_pdf = text.as_pdf;
  result.anonymous = text.anonymous || text.identity == "remove";
  if (text.as_pdf) need_pdf_printer();
  need_result_folder(text.out, result_names(result.plan));
  EvaluateOptions options = evaluate_options(program);
  options.certify = text.certify == Certify::Now;
  options.prepares_files = true;
  need_disk_of_label_maps(result.plan, text.out, options);
  result.evaluation = evaluated(program, result.plan, options);
  const Plan plan_as_read = result.plan;
  std::vector<std::string> changes;
  if (text.identity == "remove") changes = leave_out_names(result);
  if (!options.certify)
    result.findings.push_back(
        {"certificates", voxel::Verdict::Warn,
         text.certify == Certify::Later
             ? "not made yet (--certify later): no number here is checked until this page is written again"
             : "left out as requested (--certify never): no number here is checked"});
  result.pictures = plan_pictures(result.plan, result.evaluation);
  Json json = written(program, result, text.out);
  if (beside) beside();
  for (const Exported& exported : result.exported)
    for (const std::string& finding : exported.findings) warn_finding(exported.path + ": " + finding);
  if (text.certify == Certify::Later) {
    warn("written without certificates: " + (text.out / "report.html").string() + "; they follow");
    result.findings.pop_back();
    options.certify = true;
    result.evaluation = evaluate(plan_as_read, options);
    if (text.identity == "remove") leave_out_names(result);
    json = written(program, result, text.out);
  }
  if (!changes.empty()) json["identity"] = {{"choice", text.identity}, {"changes", changes}};
  program.say(json,
              verdict_text(result.evaluation) + "written: " + (text.out / "report.html").string() + "\n");
  return status_of(result);
}

void add_certify(CLI::App& verb, Certify& certify) {
  static const std::map<std::string, Certify> words{
      {"now", Certify::Now}, {"later", Certify::Later}, {"never", Certify::Never}};
  verb.add_option("--certify", certify,
                  "now; later: the result is written without certificates first and again with them; never: "
                  "faster, and no number is checked. Default: now")
      ->transform(CLI::Transformer(words))
      ->type_name("WHEN");
  verb.add_flag_callback(
      "--no-certificates", [&certify] { certify = Certify::Never; }, "The same as --certify never");
}

void add_anonymous(CLI::App& verb, bool& anonymous) {
  verb.add_flag("--anonymous", anonymous,
                "The report and its audits do not name the patient; file names are unchanged. Default: the "
                "report states name, number, birth date and study date if the scan does");
}

void add_identity(CLI::App& verb, std::string& identity, const std::string& does) {
  verb.add_option("--identity", identity, does)
      ->check(CLI::IsMember({"keep", "remove", "new"}))
      ->type_name("WORD");
}

void add_result_identity(CLI::App& verb, std::string& identity) {
  verb.add_option(
          "--identity", identity,
          "remove: the patient, the paths of scans, details of their audits, the plan's name and signatures "
          "are left out; a replay then needs --scan. Default: keep")
      ->check(CLI::IsMember({"keep", "remove"}))
      ->type_name("WORD");
}

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
  add_certify(verb, text->certify);
  verb.add_flag("--pdf", text->as_pdf, "Also print the report as report.pdf; needs Chromium on the PATH");
  add_anonymous(verb, text->anonymous);
  add_result_identity(verb, text->identity);
  const auto seen = std::make_shared<PreviewText>();
  CLI::App& draws =
      program.verb("preview", "Draws one step of a plan, without certificates",
                   "octotomy preview planner/le_fort_i.plan.json cut --scan ct=head.nrrd -o cut.png",
                   [&program, seen] { return preview_step(program, *seen); });
  draws.add_option("plan", seen->plan, "A .plan.json")->required()->check(CLI::ExistingFile);
  draws.add_option("step", seen->step, "The step's id")->required();
  add_plan_options(draws, *seen);
  draws.add_option("-o,--out", seen->out, "A .png file: the views side by side")->required();
  draws
      .add_option("--view", seen->options.views,
                  "A view, or several: anterior, left, ..., AZ,EL; default: anterior left 35,15")
      ->type_name("VIEW");
  draws.add_option("--size", seen->options.size_px, "Pixels of each view's square; default 480")
      ->check(CLI::Range(16, 4096))
      ->type_name("PX");
  add_plan_document(program);
  add_procedure(program);
}

}  // namespace octotomy::planner::cli
