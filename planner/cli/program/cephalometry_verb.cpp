// SPDX-License-Identifier: AGPL-3.0-or-later
#include <CLI/CLI.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "planner/cli/program/verbs.h"
#include "planner/cli/verb/numbers.h"
#include "planner/cli/verb/plan_in.h"
#include "planner/cli/verb/verb.h"
#include "planner/operation/file/landmarks_file.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/table/number_format.h"
#include "planner/procedure/cephalometry/cephalogram.h"
#include "planner/procedure/cephalometry/measured.h"
#include "voxel/scan/image_file.h"

namespace octotomy::planner::cli {
namespace {

namespace fs = std::filesystem;

struct CephalometryText : PlanIn {
  fs::path after, out;
  std::string definitions = "lateral";
  LandmarkDoubt doubt;
  int size_px = 900;
};

/// Landmarks with their positions before and after the operation, and the head's orientation. `evaluation` is
/// set if they come from a plan.
struct Face {
  std::vector<MovedLandmark> landmarks;
  glm::dmat3 lps_from_head{1.0};
  std::optional<Evaluation> evaluation;
};

Face face_of_files(const CephalometryText& text) {
  if (!text.out.empty())
    throw std::runtime_error(
        "-o: landmarks alone have no radiograph: give a plan with these landmarks and a scan");
  Face face;
  for (const brep::Landmark& landmark : read_landmarks(text.plan))
    face.landmarks.push_back({{landmark.name, landmark.p_mm}, glm::dmat4(1.0)});
  if (text.after.empty()) return face;
  for (const brep::Landmark& after : read_landmarks(text.after))
    for (MovedLandmark& each : face.landmarks)
      if (each.landmark.name == after.name) {
        each.moved_from_still = glm::translate(glm::dmat4(1.0), after.p_mm - each.landmark.p_mm);
        each.is_predicted = true;
      }
  return face;
}

Face face_of_plan(Program& program, const CephalometryText& text) {
  if (!text.after.empty())
    throw std::runtime_error("--after: the plan already states where its landmarks move: leave it out");
  const Plan plan = plan_of(program, text);
  if (plan.landmarks.empty())
    throw std::runtime_error(text.plan.string() + ": names no landmarks: add a landmarks step");
  EvaluateOptions options = evaluate_options(program);
  options.certify = options.meshes = false;
  Face face;
  face.evaluation = evaluated(program, plan, options);
  face.landmarks = moved_landmarks(face.evaluation->objects, plan.landmarks);
  face.lps_from_head = face.evaluation->objects.lps_from_head;
  return face;
}

void write_cephalogram(const Program& program, const CephalometryText& text, const Face& face,
                       const Cephalometry& definitions) {
  for (const Object& object : face.evaluation->objects) {
    if (!object.shown || object.moved) continue;
    const Cephalogram drawn =
        draw_cephalogram(object.shown->grey, definitions, face.landmarks, face.lps_from_head, text.size_px,
                         {program.stop.get_token(), {}});
    voxel::write_image(text.out, drawn.size_px, drawn.rgb);
    return;
  }
  throw std::runtime_error(
      "-o: no object of the plan comes from a window of a scan, so there is no radiograph");
}

std::string table_of(const CephalometricResults& found) {
  const auto with_interval = [](const std::optional<CephalometricValue>& value) {
    return value ? grouped(value->value, 1) + " \u00b1 " + grouped(value->half_width, 1) : std::string();
  };
  std::vector<std::pair<std::string, std::string>> rows;
  for (const CephalometricResult& result : found.measured) {
    const CephalometricMeasure& measure = result.measure;
    std::string row = with_interval(result.before);
    if (result.after)
      row += " -> " + with_interval(result.after) + ", change " + with_interval(result.change);
    row += std::string(" ") + (measure.unit() == std::string("deg") ? "\u00b0" : measure.unit());
    if (measure.norm)
      row += " (norm " + grouped(*measure.norm, 1) +
             (measure.deviation ? " \u00b1 " + grouped(*measure.deviation, 1) : "") + ")";
    rows.emplace_back(measure.name, row);
  }
  std::string text = lines(rows);
  for (const auto& [name, landmarks] : found.unpredicted) {
    text += "not predicted: " + name + ", because nothing states how these landmarks move:";
    for (const std::string& landmark : landmarks) text += " " + landmark;
    text += "; add a landmark_ratios step with them\n";
  }
  for (const auto& [name, landmarks] : found.lacking) {
    text += "not measured: " + name + ", lacks";
    for (const std::string& landmark : landmarks) text += " " + landmark;
    text += "\n";
  }
  return text;
}

int cephalometry(Program& program, const CephalometryText& text) {
  if (!text.out.empty()) {
    need_extension(text.out, {".png"}, "a tracing is");
    need_folder_of(text.out);
  }
  const Cephalometry definitions = read_cephalometry(text.definitions);
  const Face face =
      text.plan.string().ends_with(".plan.json") ? face_of_plan(program, text) : face_of_files(text);
  const CephalometricResults found = measured(definitions, face.landmarks, face.lps_from_head, text.doubt);
  if (found.measured.empty())
    throw std::runtime_error(text.plan.string() + ": its landmarks allow none of the measures of '" +
                             definitions.name + "': name them as octotomy cephalometry --list does");
  if (!text.out.empty()) write_cephalogram(program, text, face, definitions);
  Json json = answer({});
  json["definitions"] = definitions.name;
  json.update(to_json(found, text.doubt));
  json["path"] = text.out.empty() ? Json() : Json(text.out.string());
  program.say(json, table_of(found));
  return done;
}

int list_landmarks(const Program& program, const CephalometryText& text) {
  const Cephalometry definitions = read_cephalometry(text.definitions);
  Json json = answer({});
  json["definitions"] = definitions.name;
  json["says"] = definitions.says;
  json["landmarks"] = json["measures"] = Json::array();
  std::vector<std::pair<std::string, std::string>> rows;
  for (const CephalometricLandmark& landmark : definitions.landmarks) {
    json["landmarks"].push_back({{"name", landmark.name}, {"says", landmark.says}});
    rows.emplace_back(landmark.name, landmark.says);
  }
  for (const CephalometricMeasure& measure : definitions.measures) {
    json["measures"].push_back({{"name", measure.name}, {"says", measure.says}, {"unit", measure.unit()}});
    rows.emplace_back(measure.name, measure.says);
  }
  program.say(json, definitions.says + "\n" + lines(rows));
  return done;
}

}  // namespace

void add_cephalometry(Program& program) {
  const auto text = std::make_shared<CephalometryText>();
  const auto lists = std::make_shared<bool>(false);
  CLI::App& verb = program.verb(
      "cephalometry",
      "Angles and lengths of the face from landmarks, before and after a plan, with norms and intervals",
      "octotomy cephalometry my.plan.json -o tracing.png\n"
      "  octotomy cephalometry before.mrk.json --after followup.mrk.json --landmark-sd 0.8",
      [&program, text, lists] {
        if (*lists) return list_landmarks(program, *text);
        if (text->plan.empty())
          throw std::runtime_error(
              "name a .plan.json or a file of landmarks; --list prints the known landmarks");
        return cephalometry(program, *text);
      });
  verb.add_option("plan", text->plan,
                  "A .plan.json, or a file of landmarks: JSON, or 3D Slicer's .mrk.json or .fcsv")
      ->check(CLI::ExistingFile);
  add_plan_options(verb, *text);
  verb.add_flag("--list", *lists, "List the known landmarks and measures");
  verb.add_option("--after", text->after, "The same landmarks at a later time, if no plan moves them")
      ->check(CLI::ExistingFile);
  verb.add_option("--definitions", text->definitions,
                  "Measures: a name, or a .json file of definitions; default lateral");
  verb.add_option("--landmark-sd", text->doubt.deviation_mm,
                  "Standard deviation of a landmark's placement along each axis, mm; default 1")
      ->check(between(0.0, 20.0))
      ->type_name("MM");
  verb.add_option("--seed", text->doubt.seed, "Seed of the random trials behind the intervals; default 1");
  verb.add_option("-o,--out", text->out, "A .png of the tracing on the plan's radiograph");
  verb.add_option("--size", text->size_px, "Pixels of the picture's side; default 900")
      ->check(CLI::Range(64, 8192))
      ->type_name("PX");
}

}  // namespace octotomy::planner::cli
