// SPDX-License-Identifier: AGPL-3.0-or-later
// A first guess of a skull's landmarks, which a person checks and corrects.
#include <algorithm>
#include <map>

#include "convert/surface/isosurface.h"
#include "planner/operation/file/file_kind.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/landmark/first_guess.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/drawn_files.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {

/// Names and texts of the definitions in this folder; made when the program is configured.
const std::vector<std::pair<std::string, std::string>>& landmarks_files();

namespace {

struct Meaning {
  std::string says;
  double least_mm = 0.0;  ///< least error of a rule, however sharp, against human observers
};
std::map<std::string, Meaning> meanings() {
  std::map<std::string, Meaning> all;
  for (const auto& [file, text] : landmarks_files()) {
    const Json definitions = Json::parse(text);
    for (const Json& one : definitions["landmarks"])
      all[one["name"]] = {one["says"].get<std::string>(), one["least_mm"].get<double>()};
  }
  return all;
}

struct FindLandmarks {
  ObjectName object;
  // Of the command only.
  SampleWindow window{300.0};
  std::filesystem::path out;
};

Json guess_json(const SkullGuess& guess) {
  const std::map<std::string, Meaning> means = meanings();
  Json json{{"mid_plane",
             {{"point_mm", to_json(guess.mid_plane.plane.point_mm)},
              {"normal", to_json(guess.mid_plane.plane.normal)},
              {"rms_mm", guess.mid_plane.rms_mm},
              {"uncertainty_deg", guess.mid_plane_within_deg}}},
            {"landmarks", Json::array()},
            {"missing", Json::array()},
            {"findings", guess.findings}};
  for (const LandmarkGuess& one : guess.found)
    json["landmarks"].push_back({{"name", one.name},
                                 {"says", means.at(one.name).says},
                                 {"point_mm", to_json(one.p_mm)},
                                 {"uncertainty_mm", one.within_mm + means.at(one.name).least_mm},
                                 {"confirmed", false}});
  for (const auto& [name, why] : guess.missing)
    json["missing"].push_back({{"name", name}, {"says", means.at(name).says}, {"why", why}});
  return json;
}

Json measure(const FindLandmarks& asked, const AnswerBench& bench) {
  const Stopwatch watch(bench.timings, "landmarks");
  const Object& object = bench.objects.at(asked.object.name);
  Json json{{"object", object.id}};
  const auto nothing = [&](const std::string& why) {
    json.update({{"landmarks", Json::array()}, {"missing", Json::array()}, {"findings", {why}}});
    return json;
  };
  if (object.voxel.octree.is_empty()) return nothing("'" + object.id + "' is empty: it has no landmarks");
  if (!object.mesh.within || object.mesh.within->empty())
    return nothing("it has no mesh, whose symmetry gives the mid-plane");
  try {
    json.update(guess_json(
        guess_landmarks(drawn(object, glm::vec3(1.0f)), *object.mesh.within, bench.progress("landmarks"))));
  } catch (const std::runtime_error& error) {
    if (bench.stop.stop_requested() || !is_no_answer(error)) throw;
    return nothing(error.what());
  }
  return json;
}

/// The bone's surface, for the fit of the mid-plane.
brep::Mesh surface_of(const std::filesystem::path& file, const voxel::DrawnObject& bone,
                      const FileBench& bench) {
  if (is_mesh(file)) return read_surface(file, bench.timings);
  if (!bone.grey)
    throw std::runtime_error(
        file.string() + ": has no samples, of whose surface the mid-plane is found: give the scan or a mesh");
  const Stopwatch watch(bench.timings, "surface");
  return brep::mesh_of(convert::isosurface(
      *bone.grey, bone.threshold, std::numeric_limits<double>::infinity(), bench.progress("surface")));
}

FileAnswer on_files(const FindLandmarks& asked, const FileBench& bench) {
  if (!asked.out.empty()) {
    need_folder_of(asked.out);
    if (asked.out.extension() != ".json")
      throw std::runtime_error(asked.out.string() + ": landmarks are written as .json");
  }
  const std::filesystem::path file = asked.object.name;
  if (asked.window.high && !is_mesh(file))
    throw std::runtime_error(
        "--window " + to_string(asked.window) +
        ": landmarks are found on bone without an upper limit, for example --window 300:");
  Render render;
  render.window = asked.window;
  const voxel::DrawnObject bone = drawn_of_files(render, {asked.object}, bench).front();
  const brep::Mesh surface = surface_of(file, bone, bench);
  const SkullGuess guess = [&] {
    const Stopwatch watch(bench.timings, "landmarks");
    return guess_landmarks(bone, surface, bench.progress("landmarks"));
  }();
  FileAnswer answer{guess_json(guess)};
  if (!asked.out.empty()) {
    write_json({{"landmarks", answer.json["landmarks"]}}, asked.out);
    answer.json["path"] = asked.out.string();
    answer.rows.emplace_back("written", asked.out.string());
  }
  for (const Json& one : answer.json["landmarks"]) {
    const Json& p = one["point_mm"];
    answer.rows.emplace_back(one["name"].get<std::string>(),
                             grouped(p[0].get<double>(), 1) + ", " + grouped(p[1].get<double>(), 1) + ", " +
                                 grouped(p[2].get<double>(), 1) + " mm, within " +
                                 grouped(one["uncertainty_mm"].get<double>(), 1) + " mm");
  }
  for (const auto& [name, why] : guess.missing) answer.rows.emplace_back(name, "not found: " + why);
  answer.findings = guess.findings;
  return answer;
}

}  // namespace

Operation find_landmarks_operation() {
  return Describe<FindLandmarks>("find_landmarks",
                                 "Guesses where a skull's landmarks are, from its symmetry and its foremost, "
                                 "lowest and outermost "
                                 "points; each is to be confirmed.",
                                 Makes::Measurement)
      .takes(field("object", &FindLandmarks::object, "The skull: an object; of the verb a scan or a mesh.")
                 .required()
                 .positional("file"))
      .verb_takes(field("window", &FindLandmarks::window,
                        "Of a scan: LOW:HIGH or LOW: in sample units, or a tissue."))
      .verb_takes(
          field("out", &FindLandmarks::out,
                "The .json of the guesses. Look at each, correct it, and set its 'confirmed' to true: "
                "procedures and plans refuse it until then."))
      .reads_scans()
      .example(R"({"id": "guess", "do": "find_landmarks", "object": "rest"})")
      .on_files("octotomy find_landmarks head.nrrd -o marks.json", on_files)
      .measure(measure);
}

}  // namespace octotomy::planner
