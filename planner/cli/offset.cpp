// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/offset.h"

#include "brep/health.h"
#include "brep/measure.h"
#include "planner/answer.h"
#include "planner/cli/mesh_file.h"
#include "planner/cli/numbers.h"
#include "planner/figures.h"

namespace octotomy::planner::cli {
namespace {

struct OffsetText {
  std::filesystem::path solid, out;
  double by_mm = 0.0;
  std::optional<double> cell_mm;
};

/// Fine enough for the offset's own roundness, and no finer than some 200 cells along the solid.
double cell_for(const brep::Mesh& solid, double by_mm) {
  const brep::Size size = brep::size_of(solid);
  const glm::dvec3 extent = size.high_mm - size.low_mm;
  return std::max(0.25 * std::abs(by_mm), std::max({extent.x, extent.y, extent.z}) / 200.0);
}

int offset(const Program& program, const OffsetText& text) {
  need_mesh_extension(text.out);
  need_folder_of(text.out);
  Timings timings;
  const brep::Mesh solid = read_solid(text.solid, timings);
  brep::OffsetOptions options{.by_mm = text.by_mm,
                              .cell_mm = text.cell_mm.value_or(cell_for(solid, text.by_mm))};
  options.stop = program.stop.get_token();
  options.progress = program.progress("offset");
  brep::Mesh moved;
  {
    const Stopwatch watch(timings, "offset");
    moved = brep::offset(solid, options);
  }
  if (moved.n_faces() == 0)
    throw std::runtime_error("nothing of " + text.solid.string() + " is " + grouped(-text.by_mm, 3) +
                             " mm inside it: there is no surface to write");
  const brep::Health health = brep::health(moved);
  const brep::Measures measures = brep::measure(moved);
  write_surface(moved, text.out, timings);
  Json json = answer(timings);
  json["path"] = text.out.string();
  json["by_mm"] = text.by_mm;
  json["cell_mm"] = options.cell_mm;
  json.update(to_json(health));
  json.update(to_json(measures));
  json["volume_change_mm3"] = measures.volume_mm3 - brep::volume_mm3(solid);
  program.say(json, lines({{"written", text.out.string()},
                           {"faces", grouped(static_cast<double>(health.faces), 0)},
                           {"cells", grouped(options.cell_mm, 3) + " mm"},
                           {"volume", grouped(measures.volume_mm3, 1) + " mm\u00b3"}}));
  return done;
}

}  // namespace

void add_offset(Program& program) {
  const auto text = std::make_shared<OffsetText>();
  CLI::App& verb =
      program.verb("offset", "The surface a distance outside a solid, or inside: margins and clearances",
                   "octotomy offset tumour.stl --by 5 -o margin.stl\n"
                   "  octotomy offset skull.stl --by -1 --cell 0.4 -o core.ply --json",
                   [&program, text] { return offset(program, *text); });
  verb.add_option("solid", text->solid, "A closed mesh")->required()->check(CLI::ExistingFile);
  verb.add_option("-o,--out", text->out, "A .stl, .ply, .obj, .off, .vtp or .glb file")->required();
  verb.add_option("--by", text->by_mm, "How far out, mm; in where it is below 0")
      ->required()
      ->check(finite());
  verb.add_option(
          "--cell", text->cell_mm,
          "About the triangles' edge, mm; default: a quarter of --by, or 1/200 of the solid where that is "
          "larger")
      ->check(above_zero());
}

}  // namespace octotomy::planner::cli
