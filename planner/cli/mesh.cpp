// SPDX-License-Identifier: AGPL-3.0-or-later
#include <limits>

#include "brep/health.h"
#include "brep/measure.h"
#include "brep/write_mesh.h"
#include "convert/isosurface.h"
#include "planner/answer.h"
#include "planner/cli/mesh_file.h"
#include "planner/cli/scan_in.h"
#include "planner/figures.h"

namespace octotomy::planner::cli {
namespace {

struct MeshText {
  std::filesystem::path scan, out;
  std::string window = "300:";
  ScanIn in;
};

int mesh(const Program& program, const MeshText& text) {
  need_mesh_extension(text.out);
  need_folder_of(text.out);
  const WindowText window = parse_window(text.window);
  Timings timings;
  const voxel::Scene scene = read_scan(program, text.scan, text.in, timings);
  brep::Mesh surface;
  {
    const Stopwatch watch(timings, "isosurface");
    surface = brep::mesh_of(convert::isosurface(
        scene, window.low, window.high.value_or(std::numeric_limits<double>::infinity())));
  }
  if (surface.n_faces() == 0)
    throw std::runtime_error(text.scan.string() + ": nothing is in the window " + text.window +
                             ": choose another");
  brep::Health health;
  {
    const Stopwatch watch(timings, "health");
    health = brep::health(surface);
  }
  const brep::Measures measures = brep::measure(surface);
  {
    const Stopwatch watch(timings, "write");
    brep::write_mesh(surface, text.out);
  }
  Json json = answer(timings);
  json["kind"] = "mesh";
  json["path"] = text.out.string();
  json.update(to_json(health));
  json.update(to_json(measures));
  program.say(json, lines({{"written", text.out.string()},
                           {"faces", grouped(static_cast<double>(health.faces), 0)},
                           {"volume", grouped(measures.volume_mm3, 1) + " mm\u00b3"},
                           {"area", grouped(measures.area_mm2, 1) + " mm\u00b2"}}));
  return done;
}

}  // namespace

void add_mesh(Program& program) {
  const auto to_mesh = std::make_shared<MeshText>();
  CLI::App& mesh_verb = program.verb("mesh", "The isosurface of a scan's window",
                                     "octotomy mesh head.nrrd -o skull.stl --window 300:",
                                     [&program, to_mesh] { return mesh(program, *to_mesh); });
  mesh_verb.add_option("scan", to_mesh->scan, "A DICOM folder or file, NIfTI, NRRD or MetaImage")
      ->required()
      ->check(scan_path());
  add_scan_options(mesh_verb, to_mesh->in);
  mesh_verb.add_option("-o,--out", to_mesh->out, "A .stl, .ply, .obj or .off file")->required();
  mesh_verb.add_option("--window", to_mesh->window, "LOW:HIGH or LOW: in sample units")
      ->capture_default_str();
}

}  // namespace octotomy::planner::cli
