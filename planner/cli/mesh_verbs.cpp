// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/boolean.h"
#include "brep/boolean/exact_boolean.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "planner/cli/numbers.h"
#include "planner/cli/verb.h"
#include "planner/file/mesh_file.h"
#include "planner/measure/result_json.h"
#include "planner/table/number_format.h"

namespace octotomy::planner::cli {
namespace {

struct BooleanText {
  std::filesystem::path a, b, out;
  std::vector<std::filesystem::path> further;
  std::string operation;
  bool exact = false;
};

/// What the proof says, and the mesh in place of the result's.
Json proven(const Program& program, const brep::Mesh& a, brep::Operation operation, const brep::Mesh& b,
            brep::BooleanResult& result) {
  const brep::Watch watch{.progress = program.progress("exact"), .stop = program.stop.get_token()};
  brep::ExactBoolean exact = brep::exact_boolean(a, operation, b, watch);
  result.mesh = std::move(exact.mesh);
  result.residual = 0.0;
  return {{"identity", "|A| + |B| = |A u B| + |A n B|, as rational numbers"},
          {"a_mm3", exact.a_mm3},
          {"b_mm3", exact.b_mm3},
          {"union_mm3", exact.united_mm3},
          {"intersection_mm3", exact.intersection_mm3},
          {"result_mm3", exact.result_mm3},
          {"rounding_mm3", exact.rounding_mm3},
          {"rounded_points", exact.points}};
}

int boolean(const Program& program, const BooleanText& text) {
  need_mesh_extension(text.out);
  need_folder_of(text.out);
  Timings timings;
  if (text.exact && !text.further.empty())
    throw std::runtime_error("--exact proves one step at a time: leave --with out");
  std::vector<brep::Mesh> operands = {read_solid(text.a, timings), read_solid(text.b, timings)};
  for (const auto& path : text.further) operands.push_back(read_solid(path, timings));
  const brep::Operation operation = text.operation == "union"          ? brep::Operation::Union
                                    : text.operation == "intersection" ? brep::Operation::Intersection
                                                                       : brep::Operation::Difference;
  brep::BooleanResult result;
  Json proof = nullptr;
  {
    const Stopwatch watch(timings, "boolean_mesh");
    if (text.exact)
      proof = proven(program, operands[0], operation, operands[1], result);
    else
      result = brep::boolean(operands, operation, program.stop.get_token());
  }
  if (result.mesh.n_faces() == 0)
    throw std::runtime_error("the " + text.operation + " of " + text.a.string() + " and " + text.b.string() +
                             " is empty: there is no surface to write");
  const brep::Health health = brep::health(result.mesh);
  const brep::Measures measures = brep::measure(result.mesh);
  write_surface(result.mesh, text.out, timings);
  for (const std::string& finding : result.findings) warn(finding);
  Json json = answer(timings);
  json["path"] = text.out.string();
  json.update(to_json(measures));
  json["area_estimator"] = "triangles";
  json["health"] = to_json(health);
  json["residuals"] = {{"volume_relative", result.residual ? Json(*result.residual) : Json(nullptr)}};
  json["exact"] = proof;
  json["findings"] = result.findings;
  program.say(json, lines({{"written", text.out.string()},
                           {"volume", grouped(measures.volume_mm3, 3) + " mm\u00b3"},
                           {"area", grouped(measures.area_mm2, 3) + " mm\u00b2"}}));
  return done;
}

}  // namespace

void add_mesh_verbs(Program& program) {
  const auto to_combine = std::make_shared<BooleanText>();
  CLI::App& boolean_verb =
      program.verb("boolean", "The Boolean of two solids, by corefinement of their meshes",
                   "octotomy boolean skull.stl difference box.stl -o rest.stl --json",
                   [&program, to_combine] { return boolean(program, *to_combine); });
  boolean_verb.add_option("a", to_combine->a, "A mesh")->required()->check(CLI::ExistingFile);
  boolean_verb.add_option("op", to_combine->operation, "union, intersection or difference")
      ->required()
      ->check(CLI::IsMember({"union", "intersection", "difference"}));
  boolean_verb.add_option("b", to_combine->b, "A mesh")->required()->check(CLI::ExistingFile);
  boolean_verb.add_option("-o,--out", to_combine->out, "A .stl, .ply, .obj, .off, .vtp or .glb file")
      ->required();

  boolean_verb
      .add_option("--with", to_combine->further,
                  "Further meshes: all are united, intersected, or taken from the first")
      ->check(CLI::ExistingFile);
  boolean_verb.add_flag(
      "--exact", to_combine->exact,
      "New points as exact numbers, and proof that the volumes add up as rationals; slower");
}

}  // namespace octotomy::planner::cli
