// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/calculix_result.h"
#include "convert/deck/displacement_field.h"
#include "planner/cli/mesh_file.h"
#include "planner/cli/scan_in.h"
#include "planner/measure/result_json.h"
#include "planner/table/number_format.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner::cli {
namespace {

struct WarpText {
  std::filesystem::path in, result, out;
  ScanIn scan;
};

convert::SolvedDeck read_timed_result(const Program& program, const std::filesystem::path& path,
                                      Timings& timings) {
  const Stopwatch watch(timings, "read");
  return convert::read_solved_deck(path, {program.stop.get_token(), program.progress("reading")});
}

void warp_mesh(const WarpText& text, const convert::DisplacementField& field, Timings& timings) {
  const brep::Mesh mesh = read_surface(text.in, timings);
  brep::Mesh warped;
  {
    const Stopwatch watch(timings, "warp");
    warped = convert::warped(mesh, field);
  }
  write_surface(warped, text.out, timings);
}

void warp_scan(const Program& program, const WarpText& text, const convert::DisplacementField& field,
               Timings& timings) {
  const voxel::Scene scan = read_scan(program, text.in, text.scan, timings);
  voxel::Scene warped;
  {
    const Stopwatch watch(timings, "warp");
    warped = convert::warped(scan, field, {program.stop.get_token(), program.progress("warp")});
  }
  const Stopwatch watch(timings, "write");
  voxel::write_scene(warped, text.out);
}

int warp(const Program& program, const WarpText& text) {
  if (is_mesh(text.in)) need_mesh_extension(text.out);
  need_folder_of(text.out);
  Timings timings;
  convert::SolvedDeck deck = read_timed_result(program, text.result, timings);
  double largest_mm = 0.0;
  for (const glm::dvec3& displacement : deck.displacement_mm)
    largest_mm = std::max(largest_mm, glm::length(displacement));
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["nodes"] = deck.tetrahedra.nodes_mm.size();
  json["tets"] = deck.tetrahedra.tets.size();
  json["largest_displacement_mm"] = largest_mm;
  const convert::DisplacementField field(std::move(deck.tetrahedra), std::move(deck.displacement_mm));
  const std::size_t turned_over = field.turned_over();
  if (turned_over > 0)
    warn(std::to_string(turned_over) +
         " elements are turned over by the displacements: there the motion is too large for one linear step");
  if (is_mesh(text.in))
    warp_mesh(text, field, timings);
  else
    warp_scan(program, text, field, timings);
  json["elements_turned_over"] = turned_over;
  json["timings_ms"] = answer(timings)["timings_ms"];
  program.say(json, lines({{"written", text.out.string()},
                           {"largest displacement", grouped(largest_mm, 2) + " mm"},
                           {"elements turned over", std::to_string(turned_over)}}));
  return done;
}

}  // namespace

void add_warp(Program& program) {
  const auto text = std::make_shared<WarpText>();
  CLI::App& verb =
      program.verb("warp", "Moves a surface or a scan as a solved deck moved: the face after the operation",
                   "octotomy run face.plan.json -o out && (cd out && ccx -i face)\n"
                   "  octotomy warp skin.stl --result out/face.frd -o predicted.stl\n"
                   "  octotomy warp head.nrrd --result out/face.frd -o predicted.nrrd",
                   [&program, text] { return warp(program, *text); });
  verb.add_option("file", text->in, "A mesh, or a scan")->required()->check(scan_path());
  verb.add_option("--result", text->result, "CalculiX's .frd file of a deck of linear tetrahedra")
      ->required()
      ->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out, "A mesh, or a .nrrd, .nii.gz or .mha file")->required();
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli
