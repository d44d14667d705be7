// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/saw.h"

#include "brep/boolean.h"
#include "brep/components.h"
#include "brep/health.h"
#include "brep/measure.h"
#include "planner/answer.h"
#include "planner/cli/mesh_file.h"
#include "planner/cli/numbers.h"
#include "planner/figures.h"

namespace octotomy::planner::cli {
namespace {

struct SawText {
  std::filesystem::path solid, out;
  std::vector<std::string> line;
  std::string direction;
  double depth_mm = 100.0, kerf_mm = 1.0;
};

int saw(const Program& program, const SawText& text) {
  need_mesh_extension(text.out);
  need_folder_of(text.out);
  brep::SawCut cut;
  for (const std::string& point : text.line) cut.line_mm.push_back(parse_point("--line", point));
  cut.direction = parse_point("--direction", text.direction);
  cut.depth_mm = text.depth_mm;
  cut.kerf_mm = text.kerf_mm;
  const brep::Mesh blade = brep::saw_blade(cut);
  Timings timings;
  const brep::Mesh solid = read_solid(text.solid, timings);
  brep::BooleanResult rest;
  {
    const Stopwatch watch(timings, "boolean_mesh");
    rest = brep::boolean(solid, brep::Operation::Difference, blade, program.stop.get_token());
  }
  if (rest.mesh.n_faces() == 0)
    throw std::runtime_error("the cut takes all of " + text.solid.string() + ": there is nothing to write");
  const brep::Health health = brep::health(rest.mesh);
  const brep::Measures measures = brep::measure(rest.mesh);
  write_surface(rest.mesh, text.out, timings);
  Json pieces = Json::array();
  for (const brep::Component& piece : brep::components(rest.mesh))
    pieces.push_back({{"volume_mm3", piece.volume_mm3}, {"area_mm2", piece.area_mm2}});
  for (const std::string& finding : rest.findings) warn(finding);
  const double sawn_mm3 = brep::volume_mm3(solid) - measures.volume_mm3;
  Json json = answer(timings);
  json["path"] = text.out.string();
  json.update(to_json(measures));
  json["area_estimator"] = "triangles";
  json["health"] = to_json(health);
  json["residuals"] = {{"volume_relative", rest.residual ? Json(*rest.residual) : Json(nullptr)}};
  json["sawn_away_mm3"] = sawn_mm3;
  json["pieces"] = pieces;
  json["findings"] = rest.findings;
  program.say(json, lines({{"written", text.out.string()},
                           {"pieces", grouped(static_cast<double>(pieces.size()), 0)},
                           {"sawn away", grouped(sawn_mm3, 3) + " mm\u00b3"}}));
  return done;
}

}  // namespace

void add_saw(Program& program) {
  const auto text = std::make_shared<SawText>();
  CLI::App& verb = program.verb(
      "saw", "Cuts a solid along a line swept in one direction, as wide as the saw",
      "octotomy saw skull.stl --line -60,-120,-20 60,-120,-20 --direction 0,1,0 --depth 80 --kerf 0.8 "
      "-o cut.stl",
      [&program, text] { return saw(program, *text); });
  verb.add_option("solid", text->solid, "A closed mesh")->required()->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out, "What is left: a .stl, .ply, .obj, .off, .vtp or .glb file")
      ->required();
  verb.add_option("--line", text->line, "Points X,Y,Z of the line, two or more")->required()->expected(2, -1);
  verb.add_option("--direction", text->direction, "X,Y,Z: the way the blade goes in")->required();
  verb.add_option("--depth", text->depth_mm,
                  "How deep, in mm, from the line's first point that the blade meets")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb.add_option("--kerf", text->kerf_mm, "Width of what is sawn away, in mm")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

}  // namespace octotomy::planner::cli
