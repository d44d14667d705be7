// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the surface of voxels. The verb writes the surface of a scan's window, of an .octree file or of
// contours; the step writes the surface of an object's octree. The step `surface` writes the mesh kernel's
// answer.
#include <limits>
#include <utility>

#include "brep/io/write_mesh.h"
#include "brep/mesh/error.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/shape/decimate.h"
#include "brep/shape/smooth.h"
#include "convert/surface/cuberille.h"
#include "convert/surface/expression_surface.h"
#include "convert/surface/isosurface.h"
#include "convert/surface/partial_surface.h"
#include "convert/surface/trace_contours.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/region_file.h"
#include "planner/operation/file/step_on_files.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/tiled_slices.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/filter/tissue.h"
#include "voxel/solid/combine.h"
#include "voxel/space/disk_need.h"

namespace octotomy::planner {
namespace {

struct Meshed {
  ObjectName file;
  std::optional<SampleWindow> window;
  std::string surface = "isosurface", touching = "apart", tiling = "shortest-span";
  bool smooth = false;
  std::optional<int> faces;
  std::filesystem::path out;

  std::vector<std::string> inputs() const { return {file.name}; }
};

bool is_contour_file(const Meshed& asked) {
  return std::filesystem::path(asked.file.name).extension() == ".json";
}

/// The kind of surface to make. A file of contours can only be tiled.
std::string surface_of(const Meshed& asked) {
  return is_contour_file(asked) ? "contours" : asked.surface;
}

/// An extracted surface, with what is known about it.
struct Made {
  Made(brep::Triangles triangles) : surface(std::move(triangles)) {}  // NOLINT(google-explicit-constructor)
  /// Makes an isosurface of a lattice's samples.
  Made(brep::Triangles triangles, const voxel::Lattice& lattice)
      : surface(std::move(triangles)), stays_apart(convert::stays_apart(lattice)) {}

  brep::Triangles surface;
  bool stays_apart = false;  ///< known to have no self-intersections, for which a search is expensive
};

brep::Triangles cuberille_of(const voxel::Octree& octree, const Meshed& asked) {
  return triangles_of(convert::cuberille(
      octree, asked.touching == "apart" ? convert::Touching::Apart : convert::Touching::Together));
}

/// The window of a file with samples; bone if none is requested, with a finding.
SampleWindow window_of(const Meshed& asked, std::vector<std::string>& findings) {
  if (asked.window) return *asked.window;
  const voxel::Tissue bone = *voxel::tissue("bone");
  findings.push_back("window: " + voxel::described(bone) + ", because no --window LOW:HIGH was stated");
  return {*bone.low, std::nullopt};
}

std::optional<brep::TileCost> cost_of(const Meshed& asked) {
  return asked.tiling == "overlay"           ? std::optional<brep::TileCost>()
         : asked.tiling == "least-area"      ? brep::TileCost::least_area
         : asked.tiling == "greatest-volume" ? brep::TileCost::greatest_volume
         : asked.tiling == "least-angle"     ? brep::TileCost::least_angle
                                             : brep::TileCost::shortest_span;
}

brep::Triangles tiled_contours(const voxel::Scene& scene, const SampleWindow& window, const Meshed& asked,
                               std::vector<std::string>& findings) {
  brep::TileSectionsOptions options;
  options.cost = cost_of(asked);
  brep::TiledSections tiled = convert::contour_surface(scene, window.low, window.high_or_infinity(), options);
  findings.push_back(
      "contours: " + std::to_string(tiled.strips) + " pairs joined by strips; of these, " +
      std::to_string(tiled.clear_strips) +
      " by spans that cross no contour, because their best strips would cross other parts; of these, " +
      std::to_string(tiled.narrowed_strips) +
      " nearer to the shortest spans or by least area, because such spans would cross other parts, too; " +
      std::to_string(tiled.crossed_strips) +
      " pairs joined by overlay, because every strip would cross other parts or be too long; " +
      std::to_string(tiled.overlaid) + " branchings, ends and single contours joined by overlay");
  return std::move(tiled.surface);
}

Made of_contours(const FileBench& bench, const Meshed& asked, std::vector<std::string>& findings) {
  const std::string& file = asked.file.name;
  if (asked.window) throw std::runtime_error(file + ": already contains contours: leave --window out");
  if (asked.surface == "cuberille")
    throw std::runtime_error(file + ": contains contours, which can only be tiled: leave --surface out");
  const voxel::SliceMask mask = read_slices(file, {}, findings);
  const Stopwatch watch(bench.timings, "tile");
  TiledSlices tiled = [&] {
    try {
      return tiled_slices(mask, cost_of(asked), bench.stop);
    } catch (const brep::Error& error) {
      if (error.code() != brep::ErrorCode::Geometry) throw;
      throw brep::Error(error.code(), file + ": " + error.what());
    }
  }();
  findings.push_back("contours: " + std::to_string(mask.slices.size()) + " slices tiled by " +
                     std::to_string(tiled.sections) +
                     " sections; those between the drawn slices are interpolated");
  return tiled.solid.triangles();
}

Made of_octree(const FileBench& bench, const Meshed& asked, std::vector<std::string>& findings) {
  if (asked.surface == "contours")
    throw std::runtime_error(
        asked.file.name +
        ": contours are traced on a scan's slices: name the scan from which the octree was made");
  const voxel::OctreeFile file = octree_named(asked.file.name, bench);
  const bool cubes = asked.surface == "cuberille";
  const Stopwatch watch(bench.timings, asked.surface);
  if (const auto* grey = std::get_if<voxel::GreyOctree>(&file.tree)) {
    const SampleWindow window = window_of(asked, findings);
    if (!cubes)
      return {convert::isosurface(*grey, window.low, window.high_or_infinity()), grey->universe().lattice()};
    return cuberille_of(voxel::combine(grey->universe(), voxel::Expression(window_on(*grey, window))), asked);
  }
  if (asked.window)
    throw std::runtime_error(asked.file.name +
                             ": contains no samples, so --window does not apply: leave it out");
  if (const auto* partial = std::get_if<voxel::PartialOctree>(&file.tree)) {
    if (!cubes) return convert::isosurface(*partial);
    findings.push_back("surface: the cuberille has the voxels that are at least half filled");
    return cuberille_of(at_least_half(*partial), asked);
  }
  const auto& octree = std::get<voxel::Octree>(file.tree);
  if (cubes) return cuberille_of(octree, asked);
  findings.push_back(
      "surface: the octree has no shares of voxels and no samples, so the isosurface has steps and its area "
      "is too large (for a ball by 9 %): for a smooth surface, make a grey or partial octree");
  return convert::isosurface(octree.universe(), octree);
}

Made of_scan(const FileBench& bench, const Meshed& asked, std::vector<std::string>& findings) {
  const SampleWindow window = window_of(asked, findings);
  const voxel::Scene scene = bench.read_scan(asked.file.name);
  need_hounsfield(window, scene);
  const Stopwatch watch(bench.timings, asked.surface);
  if (asked.surface == "isosurface")
    return {convert::isosurface(scene, window.low, window.high_or_infinity()), scene.lattice};
  if (asked.surface == "contours") return tiled_contours(scene, window, asked, findings);
  throw std::runtime_error(
      asked.file.name +
      ": a cuberille is made from an octree: make the octree first with octotomy octree --window " +
      to_string(window));
}

/// The surface to write, and its size.
struct Finished {
  brep::Triangles surface;
  brep::Measures measures;
  bool stays_apart = false;
};

Finished finished(Made made, const Meshed& asked, Timings& timings) {
  const bool fewer = asked.faces && static_cast<std::size_t>(*asked.faces) < made.surface.faces.size();
  if (!asked.smooth && !fewer) {
    brep::Linked linked = brep::linked(std::move(made.surface));
    brep::Measures measures = measure(linked);
    return {std::move(linked.triangles), std::move(measures), made.stays_apart};
  }
  brep::Mesh surface = mesh_of(made.surface);
  made.surface = {};
  if (asked.smooth) {
    const Stopwatch watch(timings, "smooth");
    surface = brep::smooth(surface);
  }
  if (fewer) {
    const Stopwatch watch(timings, "decimate");
    // If the user requests a number of triangles, no bound of the error ends the decimation earlier.
    constexpr double no_bound_mm = std::numeric_limits<double>::infinity();
    surface = brep::decimate(surface,
                             {.max_error_mm = no_bound_mm, .faces = static_cast<std::size_t>(*asked.faces)});
  }
  return {triangles_of(surface), measure(surface)};
}

void check(const Meshed& asked, const FieldLocation& place) {
  if (place.scope == nullptr) return;
  check_output_path(asked.out, {".stl", ".ply", ".obj", ".off", ".vtp", ".glb"}, place.at("path"));
  if (asked.surface == "contours")
    place.at("surface").refuse("does not apply to objects, because contours are traced on a scan's slices");
}

FileAnswer on_files(const Meshed& asked, const FileBench& bench) {
  need_mesh_extension(asked.out);
  need_folder_of(asked.out);
  if (bench.step == nullptr && is_mesh(asked.file.name))
    throw std::runtime_error(asked.file.name +
                             ": already is a mesh: copy it, or change it by octotomy smooth or decimate");
  std::vector<std::string> findings;
  Made made = names_octree(asked.file.name, bench) ? of_octree(bench, asked, findings)
              : is_contour_file(asked)             ? of_contours(bench, asked, findings)
                                                   : of_scan(bench, asked, findings);
  if (made.surface.faces.empty())
    throw std::runtime_error(
        asked.file.name + ": nothing is " +
        (asked.window ? "in the window " + to_string(*asked.window) + ": choose another" : "in it"));
  if (!asked.faces)
    voxel::need_disk(asked.out, brep::least_mesh_bytes(made.surface.points_mm.size(),
                                                       made.surface.faces.size(), asked.out));
  const auto& [surface, measures, stays_apart] = finished(std::move(made), asked, bench.timings);
  brep::Health health;
  {
    const Stopwatch watch(bench.timings, "health");
    health = brep::health(surface, {.self_intersections = !stays_apart});
  }
  write_surface(surface, asked.out, bench.timings);
  FileAnswer answer{{{"kind", "mesh"}, {"path", asked.out.string()}, {"surface", surface_of(asked)}}};
  answer.json.update(to_json(health));
  answer.json.update(to_json(measures));
  for (const std::string& finding : findings) answer.json["findings"].push_back(finding);
  answer.findings = std::move(findings);
  answer.rows = {{"written", asked.out.string()},
                 {"faces", grouped(static_cast<double>(health.faces), 0)},
                 {"volume", grouped(measures.volume_mm3, 1) + " mm\u00b3"},
                 {"area", grouped(measures.area_mm2, 1) + " mm\u00b2"}};
  return answer;
}

}  // namespace

Operation mesh_operation() {
  return Describe<Meshed>("mesh", "Makes the surface of a scan's window or of an octree.", Makes::File)
      .takes(
          field("object", &Meshed::file,
                "The object; on the command line a scan, an .octree file, or a .json of regions on slices.")
              .required()
              .positional("file"))
      .verb_takes(field("window", &Meshed::window,
                        "The samples inside the surface: LOW:HIGH or LOW: in sample units, or a tissue."))
      .takes(
          field(
              "surface", &Meshed::surface,
              "isosurface: the surface where samples or filled shares cross the bound; cuberille: the faces "
              "of the voxels; contours: a surface tiled from contours on the slices of a scan or in a .json.")
              .one_of({"isosurface", "cuberille", "contours"}))
      .verb_takes(field("tiling", &Meshed::tiling,
                        "For contours: the criterion for the strips between them: shortest-span, least-area, "
                        "greatest-volume or least-angle; overlay uses no strips.")
                      .one_of({"shortest-span", "least-area", "greatest-volume", "least-angle", "overlay"})
                      .read_if<Meshed>([](const Meshed& meshed) { return surface_of(meshed) == "contours"; },
                                       "applies only to contours: add 'surface' contours"))
      .takes(
          field(
              "touching", &Meshed::touching,
              "For a cuberille: whether voxels that meet only at an edge or corner are kept apart or joined.")
              .one_of({"apart", "together"})
              .read_if<Meshed>([](const Meshed& meshed) { return meshed.surface == "cuberille"; },
                               "applies only to a cuberille: add 'surface' cuberille"))
      .takes(field("smooth", &Meshed::smooth, "Removes noise from the surface without changing its volume."))
      .takes(field("faces", &Meshed::faces, "Number of triangles to which the surface is reduced.")
                 .from(4)
                 .to(100000000))
      .takes(field("path", &Meshed::out, "The file of the surface: .stl, .ply, .obj, .off, .vtp or .glb.")
                 .required()
                 .called("out"))
      .reads_scans()
      .example(
          R"({"id": "steps", "do": "mesh", "object": "skull", "surface": "cuberille", "path": "skull.stl"})")
      .on_files(
          "octotomy mesh head.nrrd -o skull.stl --window 300:\n"
          "  octotomy mesh maxilla.octree -o maxilla.ply --surface cuberille\n"
          "  octotomy mesh head.nrrd -o skin.stl --window=-200: --surface contours\n"
          "  octotomy mesh bone.json -o bone.stl",
          on_files)
      .check(check)
      .write(write_step<Meshed, on_files>);
}

}  // namespace octotomy::planner
