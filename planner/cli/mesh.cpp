// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/shape/decimate.h"
#include "brep/shape/smooth.h"
#include "convert/surface/cuberille.h"
#include "convert/surface/expression_surface.h"
#include "convert/surface/isosurface.h"
#include "convert/surface/partial_surface.h"
#include "convert/surface/trace_contours.h"
#include "planner/cli/octree_out.h"
#include "planner/cli/scan_in.h"
#include "planner/cli/scan_verbs.h"
#include "planner/file/mesh_file.h"
#include "planner/measure/result_json.h"
#include "planner/table/number_format.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner::cli {
namespace {

struct MeshText {
  std::filesystem::path in, out;
  std::string window;
  std::string surface = "isosurface";
  std::string touching = "apart";
  std::string tiling = "shortest-span";
  bool smooth = false;
  std::optional<std::size_t> faces;
  ScanIn scan;
};

brep::Triangles cuberille_of(const voxel::Octree& octree, const MeshText& text) {
  return triangles_of(convert::cuberille(
      octree, text.touching == "apart" ? convert::Touching::Apart : convert::Touching::Together));
}

/// The object of a file that holds samples: bone where nothing else is asked for.
WindowText window_of(const MeshText& text, std::vector<std::string>& findings) {
  if (!text.window.empty()) return parse_window(text.window);
  findings.push_back("window: 300: (bone in HU), as no --window LOW:HIGH was given");
  return {300.0, std::nullopt};
}

brep::Triangles tiled_contours(const voxel::Scene& scene, const WindowText& window, const MeshText& text,
                               std::vector<std::string>& findings) {
  brep::TileSectionsOptions options;
  options.cost = text.tiling == "overlay"           ? std::optional<brep::TileCost>()
                 : text.tiling == "least-area"      ? brep::TileCost::least_area
                 : text.tiling == "greatest-volume" ? brep::TileCost::greatest_volume
                 : text.tiling == "least-angle"     ? brep::TileCost::least_angle
                                                    : brep::TileCost::shortest_span;
  brep::TiledSections tiled = convert::contour_surface(scene, window.low, window.high_or_infinity(), options);
  findings.push_back("contours: " + std::to_string(tiled.strips) + " pairs joined by strips, " +
                     std::to_string(tiled.crossed_strips) +
                     " by overlay as their strips would cross something, " + std::to_string(tiled.overlaid) +
                     " branchings, ends and lone contours by overlay");
  return std::move(tiled.surface);
}

brep::Triangles of_octree(const MeshText& text, Timings& timings, std::vector<std::string>& findings) {
  if (text.surface == "contours")
    throw std::runtime_error(text.in.string() +
                             ": contours are followed on a scan's slices: give the scan the octree is of");
  const voxel::OctreeFile file = read_timed(text.in, timings);
  const bool cubes = text.surface == "cuberille";
  const Stopwatch watch(timings, text.surface);
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree)) {
    const WindowText window = window_of(text, findings);
    if (!cubes) return convert::isosurface(*grey, window.low, window.high_or_infinity());
    return cuberille_of(voxel::combine(grey->universe(), voxel::Expression(window_on(*grey, window))), text);
  }
  if (!text.window.empty())
    throw std::runtime_error(text.in.string() + ": holds no samples to take a --window of: leave it out");
  if (const auto* partial = std::get_if<voxel::PartialOctree>(&file.tree)) {
    if (!cubes) return convert::isosurface(*partial);
    findings.push_back("surface: the cuberille is of the voxels at least half filled");
    return cuberille_of(at_least_half(*partial), text);
  }
  const auto& octree = std::get<voxel::Octree>(file.tree);
  if (cubes) return cuberille_of(octree, text);
  findings.push_back(
      "surface: the octree knows voxels only as inside or outside, so that the isosurface runs half way "
      "between "
      "them in steps and its area is too large, on a ball by 9 %: a grey or partial octree has a smooth one");
  return convert::isosurface(octree.universe(), octree);
}

brep::Triangles of_scan(const Program& program, const MeshText& text, Timings& timings,
                        std::vector<std::string>& findings) {
  const WindowText window = window_of(text, findings);
  const voxel::Scene scene = read_scan(program, text.in, text.scan, timings);
  need_hounsfield(text.window, scene);
  const Stopwatch watch(timings, text.surface);
  if (text.surface == "isosurface") return convert::isosurface(scene, window.low, window.high_or_infinity());
  if (text.surface == "contours") return tiled_contours(scene, window, text, findings);
  throw std::runtime_error(
      text.in.string() +
      ": a cuberille is of an octree's voxels: make one first with octotomy octree --window " + text.window);
}

brep::Mesh finished(brep::Mesh surface, const MeshText& text, Timings& timings) {
  if (text.smooth) {
    const Stopwatch watch(timings, "smooth");
    surface = brep::smooth(surface);
  }
  if (text.faces && *text.faces < surface.n_faces()) {
    const Stopwatch watch(timings, "decimate");
    // The number is what was asked for: no bound on the error may end it before.
    constexpr double no_bound_mm = 1e6;
    surface = brep::decimate(surface, {.max_error_mm = no_bound_mm, .faces = text.faces});
  }
  return surface;
}

int mesh(const Program& program, const MeshText& text) {
  need_mesh_extension(text.out);
  need_folder_of(text.out);
  if (is_mesh(text.in)) throw std::runtime_error(text.in.string() + ": is a mesh already");
  Timings timings;
  std::vector<std::string> findings;
  const brep::Triangles triangles =
      is_octree(text.in) ? of_octree(text, timings, findings) : of_scan(program, text, timings, findings);
  if (triangles.faces.empty())
    throw std::runtime_error(
        text.in.string() + ": nothing is " +
        (text.window.empty() ? "in it" : "in the window " + text.window + ": choose another"));
  const brep::Mesh surface = finished(brep::mesh_of(triangles), text, timings);
  brep::Health health;
  {
    const Stopwatch watch(timings, "health");
    health = brep::health(surface);
  }
  const brep::Measures measures = brep::measure(surface);
  write_surface(surface, text.out, timings);
  Json json = answer(timings);
  json["kind"] = "mesh";
  json["path"] = text.out.string();
  json["surface"] = text.surface;
  json.update(to_json(health));
  json.update(to_json(measures));
  for (const std::string& finding : findings) {
    warn(finding);
    json["findings"].push_back(finding);
  }
  program.say(json, lines({{"written", text.out.string()},
                           {"faces", grouped(static_cast<double>(health.faces), 0)},
                           {"volume", grouped(measures.volume_mm3, 1) + " mm\u00b3"},
                           {"area", grouped(measures.area_mm2, 1) + " mm\u00b2"}}));
  return done;
}

}  // namespace

void add_mesh(Program& program) {
  const auto text = std::make_shared<MeshText>();
  CLI::App& verb = program.verb("mesh", "The surface of a scan's window or of an octree",
                                "octotomy mesh head.nrrd -o skull.stl --window 300:\n"
                                "  octotomy mesh maxilla.octree -o maxilla.ply --surface cuberille\n"
                                "  octotomy mesh head.nrrd -o skin.stl --window=-200: --surface contours",
                                [&program, text] { return mesh(program, *text); });
  verb.add_option("file", text->in, "A scan, or an .octree file")->required()->check(scan_path());
  verb.add_option("-o,--out", text->out, "A .stl, .ply, .obj, .off, .vtp or .glb file")->required();
  verb.add_option("--window", text->window,
                  "LOW:HIGH or LOW: in sample units, or a tissue (bone, skin, ...)");
  verb.add_option(
          "--surface", text->surface,
          "isosurface: where samples or shares cross the bound; cuberille: the voxels' own faces; contours: "
          "followed on a scan's slices and tiled")
      ->check(CLI::IsMember({"isosurface", "cuberille", "contours"}))
      ->capture_default_str();
  verb.add_option("--tiling", text->tiling,
                  "Of contours, what strips between them are chosen by: shortest-span, least-area, "
                  "greatest-volume, least-angle; overlay: no strips")
      ->check(CLI::IsMember({"shortest-span", "least-area", "greatest-volume", "least-angle", "overlay"}))
      ->capture_default_str();
  verb.add_option("--touching", text->touching,
                  "Of a cuberille, voxels that meet at an edge or corner only: apart or together")
      ->check(CLI::IsMember({"apart", "together"}))
      ->capture_default_str();
  verb.add_flag("--smooth", text->smooth, "Take noise off the surface and keep its volume");
  verb.add_option("--faces", text->faces, "Decimate to so many triangles")->check(CLI::Range(4, 100000000));
  add_scan_options(verb, text->scan);
}

}  // namespace octotomy::planner::cli
