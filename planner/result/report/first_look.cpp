// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/first_look.h"

#include <cmath>
#include <memory>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "voxel/filter/otsu.h"
#include "voxel/filter/tissue.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/staged_files.h"

namespace octotomy::planner {
namespace {

constexpr int look_picture_px = 400;

/// A scan as a plan lists it, with the options for reading it.
Json scan_entry(const std::filesystem::path& scan, const voxel::ReadOptions& read) {
  Json entry{{"path", voxel::absolute_of(scan).string()}};
  if (!read.series.empty()) entry["series"] = read.series;
  if (read.join) entry["join"] = true;
  if (!read.slices.empty()) entry["slices"] = voxel::to_string(read.slices);
  if (read.frame) entry["frame"] = read.frame->name;
  if (read.unit) entry["unit"] = read.unit->name;
  if (read.spacing_mm) entry["spacing_mm"] = to_json(*read.spacing_mm);
  if (read.raw)
    entry["raw"] = {{"dims", {read.raw->dims.x, read.raw->dims.y, read.raw->dims.z}},
                    {"type", voxel::name_of(read.raw->type)},
                    {"big_endian", read.raw->big_endian},
                    {"offset", read.raw->offset}};
  return entry;
}

using Tell = std::function<void(const std::string&, double)>;
/// A function that reports the progress of a part as progress of the whole, from `from` to `to`.
Tell part_of(const Tell& tell, double from, double to) {
  if (!tell) return tell;
  return [=](const std::string& doing, double fraction) { tell(doing, from + (to - from) * fraction); };
}

/// Draws the bone and the skin in all views, and lists the parts of the bone.
void draw_all(Result& result) {
  {
    const Stopwatch watch(result.evaluation.timings, "components");
    result.parts.push_back(parts_of(result.evaluation.object("bone")));
  }
  const Stopwatch watch(result.evaluation.timings, "render");
  const voxel::DrawnObject bone = drawn(result.evaluation.object("bone"), {0.91f, 0.87f, 0.79f});
  const voxel::DrawnObject skin = drawn(result.evaluation.object("skin"), {0.88f, 0.72f, 0.63f});
  for (const voxel::DrawnObject& object : {bone, skin}) {
    result.pictures.push_back({object.name, object.name == "bone" ? "Bone" : "Skin", {object}, {}});
    draw(result.pictures.back(), all_views(), {skin}, look_picture_px);
  }
}

}  // namespace

Thresholds thresholds_of(const voxel::Scene& scene) {
  const std::vector<double> found = voxel::otsu_thresholds(voxel::histogram(scene), 3);
  return {std::ceil(found[0]), std::ceil(found[1])};
}

Result first_look(const std::filesystem::path& scan, const LookOptions& options) {
  Result result;
  double bone_low = options.bone_low.value_or(*voxel::tissue("bone")->low),
         skin_low = options.skin_low.value_or(*voxel::tissue("skin")->low);
  EvaluateOptions evaluation = options.evaluation;
  if (!options.bone_low || !options.skin_low) {
    if (evaluation.progress) evaluation.progress("read scan", 0.0);
    voxel::ReadOptions read = options.read;
    read.progress.stop = evaluation.stop;
    const auto read_once = std::make_shared<std::optional<voxel::Scene>>(voxel::read_scene(scan, read));
    const voxel::Scene& scene = **read_once;
    if (scene.meaning != voxel::Meaning::Hounsfield) {
      const Thresholds thresholds = thresholds_of(scene);
      bone_low = options.bone_low.value_or(thresholds.upper);
      skin_low = options.skin_low.value_or(thresholds.lower);
      result.findings.push_back(
          {"thresholds", voxel::Verdict::Warn,
           "the samples are not Hounsfield units, so bone was taken from " + grouped(bone_low, 0) +
               " and skin from " + grouped(skin_low, 0) +
               " (three classes of least variance, Otsu 1979): look at the pictures, and set --bone and "
               "--skin" +
               (scene.modality == "MR" ? "; in MR, bone is as dark as air and this is no bone" : "")});
    }
    evaluation.read_scene = [read_once, scan](const std::filesystem::path& path,
                                              const voxel::ReadOptions& how) {
      if (!*read_once) return voxel::read_scene(path, how);
      voxel::Scene taken = std::move(**read_once);
      read_once->reset();
      if (taken.source == scan.string()) taken.source = path.string();
      return taken;
    };
  }
  const std::string name =
      scan.filename().empty() ? scan.parent_path().filename().string() : scan.filename().string();
  Json plan{{"octotomy_plan", 1},
            {"name", "First look at " + (name.empty() ? scan.string() : name)},
            {"scans", {{"scan", scan_entry(scan, options.read)}}},
            {"steps",
             {{{"id", "bone"}, {"do", "window"}, {"scan", "scan"}, {"low", bone_low}},
              {{"id", "skin"}, {"do", "window"}, {"scan", "scan"}, {"low", skin_low}},
              {{"id", "bone_size"}, {"do", "measure"}, {"object", "bone"}},
              {{"id", "skin_size"}, {"do", "measure"}, {"object", "skin"}}}}};
  result.plan = parse_plan(json_text(plan, 2), std::filesystem::current_path());
  // Set directly, not as JSON, because a file's name need not be UTF-8.
  result.plan.scans.at("scan").path = scan;

  constexpr double share_of_voxels = 0.15;
  EvaluateOptions in_voxels = evaluation;
  in_voxels.certify = in_voxels.meshes = false;
  in_voxels.keep_scans = true;
  in_voxels.progress = part_of(evaluation.progress, 0.0, share_of_voxels);
  result.evaluation = evaluate(result.plan, in_voxels);
  draw_all(result);
  if (options.seen) {
    Result first = result;
    first.findings.push_back({"certificates", voxel::Verdict::Warn,
                              "not made yet: the mesh kernel is at work, and no number here is checked until "
                              "this page is written again; reload it then"});
    options.seen(std::move(first));
  }
  const Evaluation first = std::exchange(result.evaluation, {});
  evaluation.scans_of = &first;
  evaluation.progress = part_of(evaluation.progress, share_of_voxels, 1.0);
  result.evaluation = evaluate(result.plan, evaluation);
  for (const auto& [stage, milliseconds] : first.timings) result.evaluation.timings[stage] += milliseconds;
  return result;
}

}  // namespace octotomy::planner
