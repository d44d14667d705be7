// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean.h"
#include "brep/exact_boolean.h"
#include "brep/health.h"
#include "brep/measure.h"
#include "brep/smooth.h"
#include "planner/answer.h"
#include "planner/cli/mesh_file.h"
#include "planner/cli/numbers.h"
#include "planner/figures.h"

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

struct SmoothText {
  std::filesystem::path mesh, out;
  brep::SmoothOptions options;
};

int smooth(const Program& program, const SmoothText& text) {
  need_mesh_extension(text.out);
  need_folder_of(text.out);
  Timings timings;
  const brep::Mesh solid = read_solid(text.mesh, timings);
  brep::Mesh smoothed;
  {
    const Stopwatch watch(timings, "smooth");
    smoothed = brep::smooth(solid, text.options);
  }
  const brep::Health health = brep::health(smoothed);
  const brep::Measures measures = brep::measure(smoothed);
  write_surface(smoothed, text.out, timings);
  for (const std::string& finding : health.findings) warn(finding);
  const double change_mm3 = measures.volume_mm3 - brep::volume_mm3(solid);
  Json json = answer(timings);
  json["path"] = text.out.string();
  json.update(to_json(health));
  json.update(to_json(measures));
  json["volume_change_mm3"] = change_mm3;
  program.say(json, lines({{"written", text.out.string()},
                           {"volume", grouped(measures.volume_mm3, 3) + " mm\u00b3"},
                           {"gained", grouped(change_mm3, 3) + " mm\u00b3"}}));
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

  const auto to_smooth = std::make_shared<SmoothText>();
  CLI::App& smooth_verb = program.verb("smooth", "Takes noise off a solid's surface and keeps its volume",
                                       "octotomy smooth skull.stl -o smooth.stl --rounds 10 --json",
                                       [&program, to_smooth] { return smooth(program, *to_smooth); });
  smooth_verb.add_option("mesh", to_smooth->mesh, "A closed mesh")->required()->check(CLI::ExistingFile);
  smooth_verb.add_option("-o,--out", to_smooth->out, "A .stl, .ply, .obj, .off, .vtp or .glb file")
      ->required();
  smooth_verb.add_option("--rounds", to_smooth->options.rounds, "Steps in and out again")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  smooth_verb
      .add_option("--pass-band", to_smooth->options.pass_band,
                  "Waves below it stay: 0.1 keeps those over about 10 edges long")
      ->check(between(0.001, 0.999))
      ->capture_default_str();
  smooth_verb
      .add_option("--max-volume-share", to_smooth->options.max_volume_share,
                  "Share of the volume that may be gained or lost; above it nothing is written")
      ->check(above_zero())
      ->capture_default_str();
}

}  // namespace octotomy::planner::cli
