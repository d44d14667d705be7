// SPDX-License-Identifier: AGPL-3.0-or-later
// A first guess of a skull's landmarks, which a person checks and corrects.
#include <algorithm>
#include <map>

#include "convert/surface/isosurface.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/output_path.h"
#include "planner/operation/file/path_checks.h"
#include "planner/operation/landmark/first_guess.h"
#include "planner/operation/landmark/landmark_guesses.h"
#include "planner/operation/picture/drawn_files.h"
#include "planner/operation/table/fault.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {

/// Names and texts of the definition files in this folder. CMake writes this table.
const std::vector<std::pair<std::string, std::string>>& landmarks_files();

namespace {

/// A landmark's entry in the definitions of this folder.
struct Meaning {
  std::string name, says;
  double least_mm = 0.0;  ///< the least error, due to differences between human observers
};
constexpr auto members_of(const Meaning&) {
  return std::tuple(member("name", &Meaning::name), member("says", &Meaning::says),
                    member("least_mm", &Meaning::least_mm));
}
struct Definitions {
  std::vector<Meaning> landmarks;
};
constexpr auto members_of(const Definitions&) {
  return std::tuple(member("landmarks", &Definitions::landmarks));
}

std::map<std::string, Meaning> meanings() {
  std::map<std::string, Meaning> all;
  for (const auto& [file, text] : landmarks_files())
    for (const Meaning& one : record_of<Definitions>(Json::parse(text)).landmarks) all[one.name] = one;
  return all;
}

struct FindLandmarks {
  ObjectName object;
  // Of the command only.
  SampleWindow window{300.0};
  std::filesystem::path out;
};

LandmarkGuesses guesses_of(const SkullGuess& guess) {
  const std::map<std::string, Meaning> means = meanings();
  LandmarkGuesses made;
  made.mid_plane = {guess.mid_plane.plane.point_mm, guess.mid_plane.plane.normal, guess.mid_plane.rms_mm,
                    guess.mid_plane_within_deg};
  for (const LandmarkGuess& one : guess.found)
    made.landmarks.push_back(
        {one.name, means.at(one.name).says, one.p_mm, one.within_mm + means.at(one.name).least_mm, false});
  for (const auto& [name, why] : guess.missing) made.missing.push_back({name, means.at(name).says, why});
  made.findings = guess.findings;
  return made;
}

/// The guesses for an object. If there are none, the finding states the reason.
LandmarkGuesses guessed(const Object& object, const AnswerBench& bench) {
  const auto nothing = [](const std::string& why) { return LandmarkGuesses{{}, {}, {}, {why}}; };
  if (object.voxel.octree.is_empty()) return nothing("'" + object.id + "' is empty, so it has no landmarks");
  if (!object.mesh.within || object.mesh.within->empty())
    return nothing(
        "it has no mesh, but the mid-plane is computed from the symmetry of the mesh: see the object's "
        "findings");
  try {
    return guesses_of(
        guess_landmarks(drawn(object, glm::vec3(1.0f)), *object.mesh.within, bench.progress("landmarks")));
  } catch (const std::runtime_error& error) {
    if (bench.stop.stop_requested() || !is_no_answer(error)) throw;
    return nothing(error.what());
  }
}

Json measure(const FindLandmarks& asked, const AnswerBench& bench) {
  const Stopwatch watch(bench.timings, "landmarks");
  const Object& object = bench.objects.at(asked.object.name);
  Json json{{"object", object.id}};
  json.update(print_record(guessed(object, bench)));
  return json;
}

/// The bone's surface, to which the mid-plane is fitted: the mesh file, or the isosurface of the samples.
brep::Mesh surface_of(const std::filesystem::path& file, const voxel::DrawnObject& bone,
                      const FileBench& bench) {
  if (is_mesh(file)) return read_surface(file, bench.timings);
  if (!bone.grey)
    throw std::runtime_error(
        file.string() +
        ": has no samples from which a surface could be made for the mid-plane: name the scan or a mesh");
  const Stopwatch watch(bench.timings, "surface");
  return brep::mesh_of(convert::isosurface(
      *bone.grey, bone.threshold, std::numeric_limits<double>::infinity(), bench.progress("surface")));
}

FileAnswer on_files(const FindLandmarks& asked, const FileBench& bench) {
  if (!asked.out.empty()) {
    need_folder_of(asked.out);
    if (asked.out.extension() != ".json")
      throw std::runtime_error(asked.out.string() +
                               ": landmarks can only be written as .json: choose that extension");
  }
  const std::filesystem::path file = asked.object.name;
  if (asked.window.high && !is_mesh(file))
    throw std::runtime_error(
        "--window " + to_string(asked.window) +
        ": bone for landmarks must have no upper limit: write for example --window 300:");
  Render render;
  render.window = asked.window;
  const voxel::DrawnObject bone = drawn_of_files(render, {asked.object}, bench).front();
  const brep::Mesh surface = surface_of(file, bone, bench);
  const SkullGuess guess = [&] {
    const Stopwatch watch(bench.timings, "landmarks");
    return guess_landmarks(bone, surface, bench.progress("landmarks"));
  }();
  const LandmarkGuesses guesses = guesses_of(guess);
  FileAnswer answer{print_record(guesses)};
  if (!asked.out.empty()) {
    write_json({{"landmarks", print_value(guesses.landmarks)}}, asked.out);
    answer.json["path"] = asked.out.string();
    answer.rows.emplace_back("written", asked.out.string());
  }
  for (const GuessedLandmark& one : guesses.landmarks)
    answer.rows.emplace_back(one.name, grouped(one.point_mm.x, 1) + ", " + grouped(one.point_mm.y, 1) + ", " +
                                           grouped(one.point_mm.z, 1) + " mm, within " +
                                           grouped(one.uncertainty_mm, 1) + " mm");
  for (const auto& [name, why] : guess.missing) answer.rows.emplace_back(name, "not found: " + why);
  answer.findings = guess.findings;
  return answer;
}

}  // namespace

Operation find_landmarks_operation() {
  return Describe<FindLandmarks>("find_landmarks",
                                 "Guesses the positions of a skull's landmarks from its symmetry and its "
                                 "foremost, lowest and outermost points. A person must confirm each of them.",
                                 Makes::Measurement)
      .takes(field("object", &FindLandmarks::object,
                   "The skull: an object; on the command line a scan or a mesh.")
                 .required()
                 .positional("file"))
      .verb_takes(
          field("window", &FindLandmarks::window, "The bone in a scan: LOW: in sample units, or a tissue."))
      .verb_takes(field("out", &FindLandmarks::out,
                        "A .json file for the guesses. Check and correct each of them and set its "
                        "'confirmed' to true; until then, procedures and plans refuse the file."))
      .reads_scans()
      .example(R"({"id": "guess", "do": "find_landmarks", "object": "rest"})")
      .on_files("octotomy find_landmarks head.nrrd -o marks.json", on_files)
      .measure(measure);
}

}  // namespace octotomy::planner
