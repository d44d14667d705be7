// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/plan_in.h"
#include "planner/operation/file/output_path.h"
#include "planner/result/slicer/slicer_scene.h"

namespace octotomy::planner::cli {
namespace {

struct SceneText : PlanIn {
  std::filesystem::path out;
  std::string identity = "keep", transforms = "tfm";
};

std::string names(const Json& list) {
  std::string text;
  for (const Json& name : list) text += (text.empty() ? "" : ", ") + name.get<std::string>();
  return text.empty() ? "none" : text;
}

int write_scene_of(Program& program, const SceneText& text) {
  need_folder_of(text.out);
  const Plan plan = plan_of(program, text);
  EvaluateOptions options = evaluate_options(program);
  options.certify = false;
  options.keep_scans = true;
  Evaluation evaluation = evaluated(program, plan, options);
  for (const Object& object : evaluation.objects)
    for (const std::string& finding : object.findings) warn_finding(object.id + ": " + finding);
  Json written;
  {
    const Stopwatch watch(evaluation.timings, "write");
    written = write_slicer_scene(plan, evaluation, text.out,
                                 text.transforms == "h5" ? TransformFormat::Hdf5 : TransformFormat::Text,
                                 program.stop.get_token());
  }
  Json json = answer(evaluation.timings);
  json["path"] = text.out.string();
  json.update(written);
  program.say(json, lines({{"scans", names(written["scans"])},
                           {"segments", names(written["segments"])},
                           {"models", names(written["models"])},
                           {"transforms", names(written["transforms"])},
                           {"landmarks", names(written["landmarks"])},
                           {"planes", names(written["planes"])},
                           {"curves", names(written["curves"])},
                           {"lines", names(written["lines"])},
                           {"written", text.out.string()}}));
  return done;
}

}  // namespace

void add_scene(Program& program) {
  const auto text = std::make_shared<SceneText>();
  CLI::App& verb =
      program.verb("scene",
                   "Replays a plan into a scene of 3D Slicer: scans, segments, models, motions, landmarks "
                   "and cuts, uncertified",
                   "octotomy scene planner/le_fort_i.plan.json --scan ct=head.nrrd -o le_fort_i.mrb",
                   [&program, text] { return write_scene_of(program, *text); });
  verb.add_option("plan", text->plan, "A .plan.json")->required()->check(CLI::ExistingFile);
  add_plan_options(verb, *text);
  verb.add_option("-o,--out", text->out, "One .mrb, or a new folder for scene.mrml and its files")
      ->required();
  verb.add_option("--transforms", text->transforms,
                  "The format of the motions' files: tfm (text, default) or h5 (HDF5)")
      ->check(CLI::IsMember({"tfm", "h5"}));
  add_result_identity(verb, text->identity);
}

}  // namespace octotomy::planner::cli
