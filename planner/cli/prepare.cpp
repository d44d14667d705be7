// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>

#include "planner/cli/numbers.h"
#include "planner/cli/octree_out.h"
#include "planner/cli/scan_in.h"
#include "planner/cli/scan_verbs.h"
#include "planner/table/nearest_name.h"
#include "planner/table/number_format.h"
#include "voxel/filter/crop.h"
#include "voxel/filter/edge_operator.h"
#include "voxel/filter/headrest.h"
#include "voxel/filter/resample_slices.h"
#include "voxel/filter/smooth.h"
#include "voxel/filter/streak_clamp.h"
#include "voxel/scan/volume_header.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct PrepareText {
  fs::path in, out, removed;
  std::vector<std::string> steps, keep;
  ScanIn scan;
};

/// A step as it was given: NAME or NAME=VALUE,VALUE,...
struct Step {
  std::string name;
  std::vector<std::string> values;

  [[noreturn]] void refuse(const std::string& expected) const {
    std::string text = name;
    for (std::size_t i = 0; i < values.size(); ++i) text += (i == 0 ? "=" : ",") + values[i];
    throw CLI::ValidationError("--step", "'" + text + "': " + expected);
  }
  double number(std::size_t i, const std::string& expected) const {
    if (i >= values.size()) refuse(expected);
    const std::optional<double> value = parse_number(values[i]);
    if (!value) refuse(expected);
    return *value;
  }
  /// Between least and most values.
  void need(std::size_t least, std::size_t most, const std::string& expected) const {
    if (values.size() < least || values.size() > most) refuse(expected);
  }
  double number_or(std::size_t i, double otherwise, const std::string& expected) const {
    return i < values.size() ? number(i, expected) : otherwise;
  }
  int whole(std::size_t i, const std::string& expected) const {
    const double value = number(i, expected);
    if (value != std::floor(value) || std::abs(value) > 1e6) refuse(expected);
    return static_cast<int>(value);
  }
};

/// What a step works with.
struct Work {
  const PrepareText& text;
  voxel::Progress progress;
  std::optional<voxel::GreyOctree> removed;  ///< by a headrest step
};

/// Does a step; says what it did.
using Action = std::function<Json(const Step&, voxel::Scene&, Work&)>;
struct Known {
  const char* form;  ///< how it is written
  Action act;
};

Json crop_step(const Step& step, voxel::Scene& scene, Work&) {
  const std::string form = "give crop=X0,Y0,Z0,X1,Y1,Z1 in mm";
  step.need(6, 6, form);
  voxel::Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = step.number(static_cast<std::size_t>(axis), form);
    const double b = step.number(static_cast<std::size_t>(axis) + 3, form);
    box.low_mm[axis] = std::min(a, b);
    box.high_mm[axis] = std::max(a, b);
  }
  const voxel::VoxelRange range = voxel::range_within(scene.lattice, box);
  if (range.is_empty()) throw std::runtime_error(scene.source + ": no sample lies in the box of crop");
  scene = voxel::crop(scene, range);
  return {{"first_sample", {range.low.x, range.low.y, range.low.z}}};
}

Json crop_samples_step(const Step& step, voxel::Scene& scene, Work&) {
  const std::string form = "give crop_samples=I0,J0,K0,I1,J1,K1, indices from 0, both included";
  step.need(6, 6, form);
  voxel::VoxelRange range;
  for (int axis = 0; axis < 3; ++axis) {
    range.low[axis] = step.whole(static_cast<std::size_t>(axis), form);
    range.high[axis] = step.whole(static_cast<std::size_t>(axis) + 3, form);
  }
  scene = voxel::crop(scene, range);
  return Json::object();
}

Json average_step(const Step& step, voxel::Scene& scene, Work& work) {
  const std::string form = "give average_down=N or average_down=NX,NY,NZ, whole numbers from 1";
  if (step.values.size() != 1 && step.values.size() != 3) step.refuse(form);
  glm::ivec3 factor(step.whole(0, form));
  for (int axis = 1; axis < 3 && step.values.size() == 3; ++axis)
    factor[axis] = step.whole(static_cast<std::size_t>(axis), form);
  scene = voxel::average_down(scene, factor, work.progress);
  return {{"factor", {factor.x, factor.y, factor.z}}};
}

Json slices_step(const Step& step, voxel::Scene& scene, Work& work) {
  static const std::map<std::string, voxel::SliceKernel> kernels{{"nearest", voxel::SliceKernel::Nearest},
                                                                 {"linear", voxel::SliceKernel::Linear},
                                                                 {"cubic", voxel::SliceKernel::Cubic},
                                                                 {"lanczos", voxel::SliceKernel::Lanczos}};
  const std::string form = "give slices=MM or slices=MM,KERNEL: nearest, linear, cubic or lanczos";
  step.need(1, 2, form);
  const double spacing_mm = step.number(0, form);
  const std::string kernel = step.values.size() == 2                  ? step.values[1]
                             : scene.meaning == voxel::Meaning::Label ? "nearest"
                                                                      : "linear";
  const auto found = kernels.find(kernel);
  if (found == kernels.end()) step.refuse(form);
  scene = voxel::resample_slices(scene, spacing_mm, found->second, work.progress);
  return {{"spacing_mm", spacing_mm}, {"kernel", kernel}};
}

Json shape_step(const Step& step, voxel::Scene& scene, Work& work) {
  const std::string form = "give shape=MM,WINDOW, as shape=1,bone or shape=1,300:3000";
  step.need(2, 2, form);
  const WindowText window = parse_window(step.values[1]);
  need_hounsfield(step.values[1], scene);
  voxel::ShapeOptions options;
  options.spacing_mm = step.number(0, form);
  options.low = window.low;
  options.high = window.high.value_or(std::numeric_limits<double>::infinity());
  options.progress = work.progress;
  scene = voxel::interpolate_shape(scene, options);
  return {{"spacing_mm", options.spacing_mm},
          {"window", {window.low, window.high ? Json(*window.high) : Json(nullptr)}}};
}

Json median_step(const Step& step, voxel::Scene& scene, Work& work) {
  const std::string form = "give median=R or median=RX,RY,RZ, radii in samples";
  if (step.values.size() != 1 && step.values.size() != 3) step.refuse(form);
  glm::ivec3 radius(step.whole(0, form));
  for (int axis = 1; axis < 3 && step.values.size() == 3; ++axis)
    radius[axis] = step.whole(static_cast<std::size_t>(axis), form);
  scene = voxel::median(scene, radius, work.progress);
  return {{"radius_samples", {radius.x, radius.y, radius.z}}};
}

Json gaussian_step(const Step& step, voxel::Scene& scene, Work& work) {
  const std::string form = "give gaussian=SIGMA in mm";
  step.need(1, 1, form);
  const double sigma_mm = step.number(0, form);
  scene = voxel::gaussian(scene, sigma_mm, work.progress);
  return {{"sigma_mm", sigma_mm}};
}

Json diffuse_step(const Step& step, voxel::Scene& scene, Work& work) {
  const std::string form = "give edge_preserving or edge_preserving=ITERATIONS,CONDUCTANCE";
  step.need(0, 2, form);
  voxel::DiffusionOptions options;
  if (!step.values.empty()) options.iterations = step.whole(0, form);
  options.conductance = step.number_or(1, options.conductance, form);
  options.progress = work.progress;
  scene = voxel::diffuse(scene, options);
  return {{"iterations", options.iterations}, {"conductance", options.conductance}};
}

Json streaks_step(const Step& step, voxel::Scene& scene, Work& work) {
  const std::string form = "give clamp_streaks or clamp_streaks=METAL,LOW,HIGH,REACH, the reach in mm";
  step.need(0, 4, form);
  voxel::StreakOptions options;
  options.metal = step.number_or(0, options.metal, form);
  options.low = step.number_or(1, options.low, form);
  options.high = step.number_or(2, options.high, form);
  options.reach_mm = step.number_or(3, options.reach_mm, form);
  options.progress = work.progress;
  voxel::StreakClamp clamp = voxel::clamp_streaks(scene, options);
  scene = std::move(clamp.scene);
  return {{"metal", options.metal},         {"low", options.low},
          {"high", options.high},           {"reach_mm", options.reach_mm},
          {"metal_samples", clamp.metal},   {"metal_slices", clamp.slices},
          {"raised_samples", clamp.raised}, {"lowered_samples", clamp.lowered}};
}

Json headrest_step(const Step& step, voxel::Scene& scene, Work& work) {
  const std::string form = "give remove_headrest or remove_headrest=THRESHOLD,NEAR,DETACH, lengths in mm";
  step.need(0, 3, form);
  if (work.text.removed.empty())
    step.refuse("say with --removed FILE.octree where what is taken out is kept, so that it can be undone");
  if (work.removed) step.refuse("is once enough: what is taken out is kept in one file");
  voxel::HeadrestOptions options;
  options.threshold = step.number_or(0, options.threshold, form);
  options.near_mm = step.number_or(1, options.near_mm, form);
  if (step.values.size() > 2) options.detach_mm = step.number(2, form);
  for (const std::string& point : work.text.keep) options.keep_mm.push_back(parse_point("--keep", point));
  options.progress = work.progress;
  voxel::HeadrestRemoval removal = voxel::remove_headrest(std::move(scene), options);
  scene = std::move(removal.scene);
  work.removed = removal.removed;
  Json json{{"threshold", options.threshold},
            {"near_mm", options.near_mm},
            {"detach_mm", options.detach_mm ? Json(*options.detach_mm) : Json(nullptr)},
            {"parts_removed", removal.parts},
            {"volume_removed_mm3", removal.solid_mm3},
            {"samples_removed", removal.voxels},
            {"removed", work.text.removed.string()}};
  if (removal.parts == 0)
    json["finding"] =
        "nothing was removed: the patient is the only solid part; where the headrest touches the patient, "
        "cut "
        "it off with remove_headrest=-300,25,3";
  return json;
}

Json restore_step(const Step& step, voxel::Scene& scene, Work&) {
  const std::string form = "give restore=FILE.octree, as remove_headrest kept it";
  step.need(1, 1, form);
  const voxel::OctreeFile file = voxel::read_octree(step.values[0]);
  const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree);
  if (grey == nullptr) step.refuse(step.values[0] + " holds no samples: " + form);
  return {{"samples_restored", voxel::restore(scene, *grey)}, {"path", step.values[0]}};
}

Json zucker_hummel_step(const Step& step, voxel::Scene& scene, Work& work) {
  step.need(0, 0, "takes no value");
  scene = voxel::zucker_hummel(scene, work.progress);
  return {{"unit", "samples / mm"}};
}

Json marr_hildreth_step(const Step& step, voxel::Scene& scene, Work& work) {
  const std::string form = "give marr_hildreth=SIGMA in mm";
  step.need(1, 1, form);
  const double sigma_mm = step.number(0, form);
  scene = voxel::marr_hildreth(scene, sigma_mm, work.progress);
  return {{"sigma_mm", sigma_mm}, {"unit", "samples / mm\u00b2"}};
}

const std::map<std::string, Known>& known_steps() {
  static const std::map<std::string, Known> steps{
      {"crop", {"crop=X0,Y0,Z0,X1,Y1,Z1 (mm)", crop_step}},
      {"crop_samples", {"crop_samples=I0,J0,K0,I1,J1,K1", crop_samples_step}},
      {"average_down", {"average_down=N or NX,NY,NZ", average_step}},
      {"slices", {"slices=MM,KERNEL (nearest, linear, cubic, lanczos)", slices_step}},
      {"shape", {"shape=MM,WINDOW (binary slices by shape)", shape_step}},
      {"median", {"median=R or RX,RY,RZ (samples)", median_step}},
      {"gaussian", {"gaussian=SIGMA (mm)", gaussian_step}},
      {"edge_preserving", {"edge_preserving=ITERATIONS,CONDUCTANCE", diffuse_step}},
      {"clamp_streaks", {"clamp_streaks=METAL,LOW,HIGH,REACH", streaks_step}},
      {"remove_headrest", {"remove_headrest=THRESHOLD,NEAR,DETACH (needs --removed)", headrest_step}},
      {"restore", {"restore=FILE.octree", restore_step}},
      {"zucker_hummel", {"zucker_hummel", zucker_hummel_step}},
      {"marr_hildreth", {"marr_hildreth=SIGMA (mm)", marr_hildreth_step}},
  };
  return steps;
}

Step step_of(const std::string& text) {
  const auto equals = text.find('=');
  Step step{text.substr(0, equals), {}};
  if (!known_steps().contains(step.name)) {
    std::vector<std::string> names;
    for (const auto& [name, unused] : known_steps()) names.push_back(name);
    throw CLI::ValidationError("--step",
                               "there is no step '" + step.name + "'" + suggestion(step.name, names));
  }
  for (std::size_t at = equals; at != std::string::npos;) {
    const auto comma = text.find(',', at + 1);
    step.values.push_back(text.substr(at + 1, comma == std::string::npos ? comma : comma - at - 1));
    at = comma;
  }
  return step;
}

Json lattice_json(const voxel::Scene& scene) {
  const glm::ivec3 dims = scene.lattice.dims;
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  return {{"dims", {dims.x, dims.y, dims.z}}, {"spacing_mm", to_json(spacing_mm)}};
}

void write_removed(const PrepareText& text, const voxel::GreyOctree& removed, Timings& timings) {
  const Stopwatch watch(timings, "write");
  const Json made{{"made_by", std::string("octotomy ") + OCTOTOMY_VERSION},
                  {"scan", text.in.filename().string()},
                  {"holds", "samples taken out by remove_headrest; restore puts them back"}};
  voxel::write_octree({removed, text.removed.stem().string(), made.dump()}, text.removed);
}

int prepare(const Program& program, const PrepareText& text) {
  if (!voxel::volume_format(text.out))
    throw std::runtime_error(text.out.string() + ": unknown kind of scan; use .nrrd, .nii.gz or .mha");
  need_folder_of(text.out);
  if (!text.removed.empty()) {
    need_octree_extension(text.removed);
    need_folder_of(text.removed);
  }
  std::vector<Step> steps;
  for (const std::string& step : text.steps) steps.push_back(step_of(step));
  Timings timings;
  voxel::Scene scene = read_scan(program, text.in, text.scan, timings);
  Work work{text, {program.stop.get_token(), {}}, std::nullopt};
  Json did = Json::array();
  std::vector<std::pair<std::string, std::string>> rows;
  for (const Step& step : steps) {
    work.progress.report = program.progress(step.name);
    Json said{{"do", step.name}};
    {
      const Stopwatch watch(timings, step.name);
      said.update(known_steps().at(step.name).act(step, scene, work));
    }
    said.update(lattice_json(scene));
    if (work.progress.report) work.progress.report(1.0);
    if (said.contains("finding")) warn(step.name + ": " + said["finding"].get<std::string>());
    rows.emplace_back(step.name, dims_text(scene.lattice.dims) +
                                     (said.contains("volume_removed_mm3")
                                          ? ", " + grouped(said["volume_removed_mm3"].get<double>(), 0) +
                                                " mm\u00b3 removed"
                                          : ""));
    did.push_back(std::move(said));
  }
  if (program.stop.stop_requested()) throw Stopped("stopped before " + text.out.string() + " was written");
  {
    const Stopwatch watch(timings, "write");
    voxel::write_scene(scene, text.out);
  }
  if (work.removed) write_removed(text, *work.removed, timings);
  Json json = scan_answer(scene, timings);
  json["path"] = text.out.string();
  json["steps"] = std::move(did);
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
      "  octotomy prepare head.nrrd -o clean.nrrd --step remove_headrest --removed table.octree\n"
      "  octotomy prepare clean.nrrd -o head_again.nrrd --step restore=table.octree",
      [&program, text] { return prepare(program, *text); });
  std::string forms;
  for (const auto& [name, step] : known_steps())
    forms += (forms.empty() ? "" : "; ") + std::string(step.form);
  verb.add_option("scan", text->in, "A DICOM folder or file, NIfTI, NRRD, MetaImage, images, or a raw file")
      ->required()
      ->check(scan_path());
  verb.add_option("-o,--out", text->out, "A .nrrd, .nii.gz or .mha file")->required();
  verb.add_option("--step", text->steps, "Again for more: " + forms)->required()->expected(1)->take_all();
  verb.add_option("--removed", text->removed, "The .octree file that keeps what remove_headrest takes out");
  verb.add_option("--keep", text->keep, "X,Y,Z in mm of a part that remove_headrest leaves, again for more")
      ->expected(1)
      ->take_all();
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli
