// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/components.h"
#include "convert/deck.h"
#include "convert/tetrahedralise.h"
#include "planner/answer.h"
#include "planner/cli/mesh_file.h"
#include "planner/figures.h"

namespace octotomy::planner::cli {
namespace {

struct TetText {
  std::filesystem::path mesh, out;
  convert::TetOptions options;
  std::optional<double> max_volume_mm3;
  double seconds = 60.0;
};

int tet(const Program& program, TetText text) {
  const std::string extension = text.out.extension().string();
  if (extension != ".inp" && extension != ".vtu")
    throw std::runtime_error(text.out.string() + ": a deck is written as .inp or .vtu");
  need_folder_of(text.out);
  Timings timings;
  const brep::Mesh solid = read_solid(text.mesh, timings);
  if (text.max_volume_mm3) {
    text.options.limit_volume = true;
    text.options.max_volume_mm3 = *text.max_volume_mm3;
  }
  text.options.time_limit = std::chrono::seconds(static_cast<long>(text.seconds));
  convert::Tetrahedra tetrahedra;
  {
    const Stopwatch watch(timings, "tetrahedralise");
    tetrahedra = convert::tetrahedralise(solid, text.options);
  }
  const convert::TetQuality quality = convert::quality(tetrahedra);
  {
    const Stopwatch watch(timings, "write");
    convert::write_deck(tetrahedra, text.out, {.title = text.mesh.filename().string()});
  }
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["nodes"] = tetrahedra.nodes_mm.size();
  json["tets"] = tetrahedra.tets.size();
  json["regions"] = brep::components(solid).size();
  json["volume_mm3"] = quality.volume_mm3;
  json["quality"] = {{"min_dihedral_deg", quality.min_dihedral_deg},
                     {"max_dihedral_deg", quality.max_dihedral_deg},
                     {"max_radius_edge", quality.max_radius_edge}};
  json["fallback"] = nullptr;
  json["findings"] = {"fallback: none was needed"};
  program.say(json, lines({{"written", text.out.string()},
                           {"tetrahedra", grouped(static_cast<double>(tetrahedra.tets.size()), 0)},
                           {"dihedral", grouped(quality.min_dihedral_deg, 1) + " to " +
                                            grouped(quality.max_dihedral_deg, 1) + " degrees"}}));
  return done;
}

}  // namespace

void add_tet(Program& program) {
  const auto to_fill = std::make_shared<TetText>();
  CLI::App& tet_verb = program.verb("tet", "Fills a solid with quality tetrahedra for finite elements",
                                    "octotomy tet maxilla.stl -o maxilla.inp --radius-edge 1.4 --json",
                                    [&program, to_fill] { return tet(program, *to_fill); });
  tet_verb.add_option("mesh", to_fill->mesh, "A closed mesh")->required()->check(CLI::ExistingFile);
  tet_verb.add_option("-o,--out", to_fill->out, "A .inp (Abaqus, CalculiX) or .vtu file")->required();
  tet_verb
      .add_option("--radius-edge", to_fill->options.radius_edge,
                  "Largest circumradius by shortest edge; 1.2 is hard, 2 is easy")
      ->check(CLI::Range(1.1, 10.0))
      ->capture_default_str();
  tet_verb.add_option("--max-volume", to_fill->max_volume_mm3, "Largest tetrahedron, mm3")
      ->check(CLI::PositiveNumber);
  tet_verb.add_flag("!--refine-boundary", to_fill->options.keep_boundary,
                    "Let TetGen add points on the surface; by default it is kept as it is");
  tet_verb.add_option("--seconds", to_fill->seconds, "Time that TetGen may take")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
}

}  // namespace octotomy::planner::cli
