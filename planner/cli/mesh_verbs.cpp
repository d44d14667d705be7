// SPDX-License-Identifier: AGPL-3.0-or-later
#include <limits>

#include "brep/boolean.h"
#include "brep/components.h"
#include "brep/health.h"
#include "brep/measure.h"
#include "brep/read_mesh.h"
#include "brep/smooth.h"
#include "brep/write_mesh.h"
#include "convert/deck.h"
#include "convert/isosurface.h"
#include "convert/tetrahedralise.h"
#include "planner/answer.h"
#include "planner/cli/scan_in.h"
#include "planner/figures.h"

namespace octotomy::planner::cli {
namespace {

/// A mesh that Booleans and tetrahedra can be made of; throws where it is not closed and oriented.
brep::Mesh read_solid(const std::filesystem::path& path, Timings& timings) {
  const Stopwatch watch(timings, "read");
  const brep::Triangles triangles = brep::read_triangles(path);
  const brep::Health health = brep::health(triangles);
  if (!health.solid())
    throw std::runtime_error(path.string() + ": is not a solid: " + health.findings.front() +
                             "; mend it first, octotomy info tells all");
  return brep::mesh_of(triangles);
}

void check_mesh_extension(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  for (const char* known : {".stl", ".ply", ".obj", ".off"})
    if (extension == known) return;
  throw std::runtime_error(path.string() + ": a mesh is written as .stl, .ply, .obj or .off");
}

struct MeshText {
  std::filesystem::path scan, out;
  std::string window = "300:";
  ScanIn in;
};

int mesh(const Program& program, const MeshText& text) {
  check_mesh_extension(text.out);
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

struct BooleanText {
  std::filesystem::path a, b, out;
  std::string operation;
};

int boolean(const Program& program, const BooleanText& text) {
  check_mesh_extension(text.out);
  need_folder_of(text.out);
  Timings timings;
  const brep::Mesh a = read_solid(text.a, timings);
  const brep::Mesh b = read_solid(text.b, timings);
  const brep::Operation operation = text.operation == "union"          ? brep::Operation::Union
                                    : text.operation == "intersection" ? brep::Operation::Intersection
                                                                       : brep::Operation::Difference;
  brep::BooleanResult result;
  {
    const Stopwatch watch(timings, "boolean_mesh");
    result = brep::boolean(a, operation, b);
  }
  if (result.mesh.n_faces() == 0)
    throw std::runtime_error("the " + text.operation + " of " + text.a.string() + " and " + text.b.string() +
                             " is empty: there is no surface to write");
  const brep::Health health = brep::health(result.mesh);
  const brep::Measures measures = brep::measure(result.mesh);
  {
    const Stopwatch watch(timings, "write");
    brep::write_mesh(result.mesh, text.out);
  }
  for (const std::string& finding : result.findings) warn(finding);
  Json json = answer(timings);
  json["path"] = text.out.string();
  json.update(to_json(measures));
  json["area_estimator"] = "triangles";
  json["health"] = to_json(health);
  json["residuals"] = {{"volume_relative", result.residual ? Json(*result.residual) : Json(nullptr)}};
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
  check_mesh_extension(text.out);
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
  {
    const Stopwatch watch(timings, "write");
    brep::write_mesh(smoothed, text.out);
  }
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

void add_mesh_verbs(Program& program) {
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
  boolean_verb.add_option("-o,--out", to_combine->out, "A .stl, .ply, .obj or .off file")->required();

  const auto to_smooth = std::make_shared<SmoothText>();
  CLI::App& smooth_verb = program.verb("smooth", "Takes noise off a solid's surface and keeps its volume",
                                       "octotomy smooth skull.stl -o smooth.stl --rounds 10 --json",
                                       [&program, to_smooth] { return smooth(program, *to_smooth); });
  smooth_verb.add_option("mesh", to_smooth->mesh, "A closed mesh")->required()->check(CLI::ExistingFile);
  smooth_verb.add_option("-o,--out", to_smooth->out, "A .stl, .ply, .obj or .off file")->required();
  smooth_verb.add_option("--rounds", to_smooth->options.rounds, "Steps in and out again")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  smooth_verb
      .add_option("--pass-band", to_smooth->options.pass_band,
                  "Waves below it stay: 0.1 keeps those over about 10 edges long")
      ->check(CLI::Range(0.001, 0.999))
      ->capture_default_str();
  smooth_verb
      .add_option("--max-volume-share", to_smooth->options.max_volume_share,
                  "Share of the volume that may be gained or lost; above it nothing is written")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();

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
