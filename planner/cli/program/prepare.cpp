// SPDX-License-Identifier: AGPL-3.0-or-later
// A plan of operations that each make a scan from the previous one.
#include <CLI/CLI.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/octree_out.h"
#include "planner/cli/verb/scan_in.h"
#include "planner/operation/file/label_table.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/file/write_label_table.h"
#include "planner/operation/picture/removed_picture.h"
#include "planner/operation/table/field_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/number_format.h"
#include "voxel/scan/image_file.h"
#include "voxel/scan/write_scene.h"
#include "voxel/volume/volume_header.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct PrepareText {
  fs::path in, out, removed, picture;
  std::vector<std::string> steps, keep;
  ScanIn scan;
};

/// The operations that make a scan from another scan alone. Operations that also need objects can only be
/// steps of plans.
std::vector<const Operation*> known_steps() {
  std::vector<const Operation*> known;
  for (const Operation& operation : operations())
    if (operation.makes == Makes::Scan && !operation.verb_example.empty()) known.push_back(&operation);
  return known;
}

/// The action of a step in the form NAME or NAME=VALUE,VALUE,...
Action step_of(const std::string& text, const PrepareText& given) {
  const auto equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const Operation* operation = find_operation(name);
  if (operation == nullptr || operation->makes != Makes::Scan || operation->verb_example.empty()) {
    std::vector<std::string> names;
    for (const Operation* known : known_steps()) names.push_back(known->name);
    throw CLI::ValidationError("--step", "there is no step '" + name + "'" + suggestion(name, names));
  }
  std::vector<std::string> values;
  for (std::size_t at = equals; at != std::string::npos;) {
    const auto comma = text.find(',', at + 1);
    values.push_back(text.substr(at + 1, comma == std::string::npos ? comma : comma - at - 1));
    at = comma;
  }
  Action action(*operation);
  try {
    nlohmann::json step = json_of_values(operation->fields, action.value(), values);
    step["scan"] = "scan";
    if (name == "remove_headrest" && given.removed.empty())
      throw std::runtime_error(
          "give --removed FILE.octree, which keeps the removed samples so that restore can undo the step");
    for (const Field& field : operation->fields)
      if (field.name == "keep_mm" && !given.keep.empty())
        step[field.name] = json_of_words(field, action.value(), given.keep);
    read_fields(operation->fields, step, action.value(), {});
    if (operation->check) operation->check(action.value(), {});
  } catch (const std::runtime_error& error) {
    throw CLI::ValidationError("--step", std::string("'").append(text).append("': ").append(error.what()) +
                                             "; give " + operation->verb_example);
  }
  return action;
}

/// The file that a step "restore" reads; empty for other steps.
fs::path read_by(const std::string& step) {
  constexpr std::string_view restore = "restore=";
  return step.starts_with(restore) ? step.substr(restore.size()) : "";
}

/// Refuses outputs that cannot be written, before any input is read.
void check_outputs(const PrepareText& text) {
  if (!voxel::volume_format(text.out))
    throw std::runtime_error(text.out.string() + ": unknown kind of scan; use .nrrd, .nii.gz or .mha");
  if (!text.removed.empty()) need_octree_extension(text.removed);
  std::vector<fs::path> read{text.in};
  for (const std::string& step : text.steps) read.push_back(read_by(step));
  if (!text.picture.empty() && text.picture.extension() != ".png")
    throw std::runtime_error(text.picture.string() + ": the picture of the removed samples is a .png file");
  need_outputs({text.out, text.removed, text.picture}, read);
}

void write_removed(const PrepareText& text, const voxel::GreyOctree& removed, Outputs& outputs,
                   Timings& timings) {
  const Stopwatch watch(timings, "write");
  const Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                  {"scan", text.in.filename().string()},
                  {"holds", "samples taken out by remove_headrest; restore puts them back"}};
  outputs.write(text.removed, [&](const fs::path& file) {
    voxel::write_octree({removed, text.removed.stem().string(), json_text(made)}, file);
  });
}

int prepare(const Program& program, const PrepareText& text) {
  check_outputs(text);
  std::vector<Action> steps;
  for (const std::string& step : text.steps) steps.push_back(step_of(step, text));
  if (std::count_if(steps.begin(), steps.end(),
                    [](const Action& step) { return step.operation().name == "remove_headrest"; }) > 1)
    throw CLI::ValidationError(
        "--step",
        "'remove_headrest' may be given only once, because the removed parts are stored in one file");
  if (!text.picture.empty() && std::none_of(steps.begin(), steps.end(), [](const Action& step) {
        return step.operation().name == "remove_headrest";
      }))
    throw CLI::ValidationError("--picture",
                               "only remove_headrest draws a picture: add --step remove_headrest");
  Timings timings;
  voxel::Scene scene = read_scan(program, text.in, text.scan, timings);
  const LabelTable table = names_of_labels(scene, text.in);
  std::optional<voxel::GreyOctree> removed;
  std::optional<RemovedPicture> picture;
  Json did = Json::array();
  std::vector<std::pair<std::string, std::string>> rows;
  for (const Action& step : steps) {
    const std::string& name = step.operation().name;
    const voxel::Progress progress{program.stop.get_token(), program.progress(name)};
    MadeScan made;
    {
      const Stopwatch watch(timings, name);
      made = step.operation().scan(
          step.value(),
          {[&](const std::string&) -> const voxel::Scene& { return scene; }, timings, progress});
    }
    if (progress.report) progress.report(1.0);
    if (made.removed && !text.picture.empty()) picture = removed_picture(scene, made.scene);
    scene = std::move(made.scene);
    const glm::ivec3 dims = scene.lattice.dims;
    Json said{{"do", name}};
    said.update(made.details);
    if (made.removed) {
      removed = std::move(made.removed);
      said["removed"] = text.removed.string();
      if (picture) said["picture"] = text.picture.string();
    }
    std::string all;
    for (const std::string& finding : made.findings) {
      all += (all.empty() ? "" : "; ") + finding;
      said["finding"] = all;
      warn(name + ": " + finding);
    }
    said["dims"] = {dims.x, dims.y, dims.z};
    said["spacing_mm"] = to_json(scene.lattice.spacing_mm());
    rows.emplace_back(
        name, dims_text(dims) +
                  (said.contains("volume_removed_mm3")
                       ? ", " + grouped(said["volume_removed_mm3"].get<double>(), 0) +
                             " mm\u00b3 solid and " + grouped(said["foam_removed_mm3"].get<double>(), 0) +
                             " mm\u00b3 of foam and edges removed, " +
                             grouped(said["dense_removed_mm3"].get<double>(), 0) + " as dense as bone"
                       : ""));
    did.push_back(std::move(said));
  }
  if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  const bool has_names = scene.meaning == voxel::Meaning::Label && !table.names.empty();
  if (has_names) need_label_table(text.out, table.names);
  Outputs outputs;
  {
    const Stopwatch watch(timings, "write");
    outputs.write(text.out, [&](const fs::path& file) { voxel::write_scene(scene, file); });
  }
  if (removed) write_removed(text, *removed, outputs, timings);
  if (picture)
    outputs.write(text.picture,
                  [&](const fs::path& file) { voxel::write_image(file, picture->size_px, picture->rgb); });
  outputs.commit();
  std::vector<std::string> findings = table.passed_over;
  if (has_names)
    for (std::string& finding : write_label_table(text.out, table.names))
      findings.push_back(std::move(finding));
  Json json = scan_answer(scene, timings);
  json["path"] = text.out.string();
  json["steps"] = std::move(did);
  json["findings"] = findings;
  for (const std::string& finding : findings) warn_finding(finding);
  rows.emplace_back("written", text.out.string());
  program.say(json, lines(rows));
  return done;
}

}  // namespace

void add_prepare(Program& program) {
  const auto text = std::make_shared<PrepareText>();
  CLI::App& verb = program.verb(
      "prepare", "Crops, resamples, smooths and cleans a scan, step by step in the order given",
      "octotomy prepare head.nrrd -o ready.nrrd --step crop=-90,-120,-80,90,110,90 --step slices=1,cubic\n"
      "  octotomy prepare head.nrrd -o clean.nrrd --step remove_headrest --removed table.octree --picture "
      "table.png\n"
      "  octotomy prepare clean.nrrd -o head_again.nrrd --step restore=table.octree",
      [&program, text] { return prepare(program, *text); });
  std::string forms;
  for (const Operation* step : known_steps()) forms += (forms.empty() ? "" : "; ") + step->verb_example;
  verb.add_option("scan", text->in, "A DICOM folder or file, NIfTI, NRRD, MetaImage, images, or a raw file")
      ->required()
      ->check(scan_path());
  verb.add_option("-o,--out", text->out, "A .nrrd, .nii.gz or .mha file")->required();
  verb.add_option("--step", text->steps, "Again for more: " + forms)->required()->expected(1)->take_all();
  verb.add_option("--removed", text->removed,
                  "The .octree file that keeps the samples that remove_headrest removes");
  verb.add_option("--picture", text->picture,
                  "A .png file that shows in red the samples that remove_headrest removes");
  verb.add_option("--keep", text->keep, "X,Y,Z in mm of a part that remove_headrest keeps; may be repeated")
      ->expected(1)
      ->take_all();
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli
