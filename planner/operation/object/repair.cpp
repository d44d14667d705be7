// SPDX-License-Identifier: AGPL-3.0-or-later
// A mesh of any program, repaired in the requested ways, as an object. Its voxels are digitised from it, so
// that it has no certificate of its own.
#include "brep/shape/repair.h"

#include <algorithm>
#include <cmath>

#include "brep/io/write_mesh.h"
#include "brep/mesh/health.h"
#include "brep/shape/repair_effect.h"
#include "planner/operation/file/mesh_file.h"
#include "planner/operation/file/mesh_in.h"
#include "planner/operation/file/outputs.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Repair {
  std::filesystem::path path, out;
  std::optional<std::string> frame, unit;
  std::optional<double> weld_mm, longest_hole_mm, cell_mm, wall_mm;
  bool duplicates = false, orient = false, flat = false, holes = false, intersections = false, solid = false,
       hull = false;
  double max_volume_share = brep::RepairOptions{}.max_volume_share;
};

void check(const Repair& repair, const FieldLocation& place) {
  if (!repair.weld_mm && !repair.duplicates && !repair.orient && !repair.flat && !repair.holes &&
      !repair.intersections && !repair.solid)
    place.refuse(
        "makes only repairs that are requested: add 'solid' for all, or 'weld_mm', 'duplicates', 'flat', "
        "'orient', 'holes' or 'intersections'; octotomy info lists a mesh's defects");
  if (repair.wall_mm && repair.hull)
    place.at("hull").refuse("fills the inside, but 'wall_mm' leaves it hollow: state only one of them");
  if ((repair.hull || repair.cell_mm || repair.wall_mm) && !repair.solid)
    place.at(repair.hull      ? "hull"
             : repair.cell_mm ? "cell_mm"
                              : "wall_mm")
        .refuse("applies only to a surface that is built anew: add 'solid'");
}

Json changes_json(const std::vector<brep::Change>& changes) {
  Json list = Json::array();
  for (const brep::Change& change : changes)
    list.push_back({{"step", change.step}, {"what", change.what}, {"at_mm", to_json(change.at_mm)}});
  return list;
}

/// The surface before and after the repair.
struct Mended {
  brep::Triangles read;
  brep::Repair repaired;
};

Mended mended(const Repair& repair, const std::filesystem::path& path, const voxel::Progress& progress,
              Timings& timings) {
  Mended made;
  {
    const Stopwatch watch(timings, "read");
    made.read = read_mesh_in(path, {repair.frame, repair.unit});
  }
  const Stopwatch watch(timings, "repair");
  brep::RepairOptions options;
  options.weld_mm = repair.weld_mm;
  options.remove_duplicates = repair.duplicates;
  options.orient = repair.orient;
  options.remove_flat = repair.flat;
  options.fill_holes = repair.holes;
  options.longest_hole_mm = repair.longest_hole_mm;
  options.remove_intersections = repair.intersections;
  options.solid = repair.solid;
  options.cell_mm = repair.cell_mm;
  options.hull = repair.hull;
  options.wall_mm = repair.wall_mm;
  options.max_volume_share = repair.max_volume_share;
  options.progress = {progress.stop, progress.report};
  made.repaired = brep::repair(made.read, options);
  return made;
}

/// The repairs and the repaired mesh, as JSON.
Json told(const Mended& made, const brep::RepairEffect& effect, const brep::KnownSolids& solids) {
  const auto estimator = [](bool is_solid) {
    return is_solid ? "divergence theorem over the mesh"
                    : "lengths of parallel lines inside the mesh; lines through holes are left out";
  };
  return {{"changes", changes_json(made.repaired.changes)},
          {"left", changes_json(made.repaired.left)},
          {"method", made.repaired.enclosed_cell_mm ? "enclosed" : "mended"},
          {"cell_mm", made.repaired.enclosed_cell_mm ? Json(*made.repaired.enclosed_cell_mm) : Json(nullptr)},
          {"volume_before_mm3", effect.volume_before_mm3},
          {"volume_after_mm3", effect.volume_after_mm3},
          {"volume_before_estimator", estimator(solids.before)},
          {"volume_after_estimator", estimator(solids.after)},
          {"open_line_share", effect.open_line_share},
          {"area_before_mm2", effect.area_before_mm2},
          {"area_after_mm2", effect.area_after_mm2},
          {"largest_distance_mm", effect.largest_distance_mm},
          {"largest_distance_at_mm", to_json(effect.largest_at_mm)}};
}

/// Adds a finding on sheets that were removed because, as shells, they enclose nothing; none if they were
/// only a small share of the surface.
void add_lost_sheets(const Mended& made, const brep::RepairEffect& effect,
                     std::vector<std::string>& findings) {
  constexpr double little = 0.05;
  const auto films = std::count_if(made.repaired.changes.begin(), made.repaired.changes.end(),
                                   [](const brep::Change& change) { return change.step == "films"; });
  const double lost_share = 1.0 - effect.area_after_mm2 / std::max(effect.area_before_mm2, 1e-300);
  if (films == 0 || lost_share < little) return;
  findings.push_back("WARN films: shells that enclose nothing were removed, " + std::to_string(films) +
                     " triangles; the surface lost " + three_figures(100.0 * lost_share) +
                     " % of the area: to keep sheets as walls, use octotomy repair --solid --wall MM");
}

std::string definition(const Repair& repair, const Objects&) {
  return repair.path.filename().string() + ", mended";
}

void triangles(const Repair& repair, const MeshBench& bench, MeshSide& made) {
  const Mended mended_mesh = mended(repair, bench.folder / repair.path, bench.progress, bench.timings);
  const brep::Health health = brep::health(mended_mesh.repaired.surface);
  if (!health.solid())
    throw std::runtime_error(repair.path.string() + ": is still not a solid: " + health.findings.front() +
                             "; request more repairs");
  constexpr brep::KnownSolids solids{.before = false, .after = true};
  const brep::RepairEffect effect =
      brep::repair_effect(mended_mesh.read, mended_mesh.repaired.surface, solids);
  made.details = told(mended_mesh, effect, solids);
  add_lost_sheets(mended_mesh, effect, made.findings);
  made.whole = brep::trusted_solid(mended_mesh.repaired.surface, brep::Proof::Construction);
  made.lineage = "triangles of " + repair.path.filename().string() + ", mended";
}

void bound(const Repair&, const BoundBench&, Object&) {}

/// The triangles with finite points, because brep::health() accepts no others.
brep::Triangles without_wild_points(brep::Triangles triangles) {
  std::erase_if(triangles.faces, [&](const auto& face) {
    return std::any_of(face.begin(), face.end(), [&](std::uint32_t v) {
      const glm::dvec3& p = triangles.points_mm[v];
      return !std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z);
    });
  });
  return triangles;
}

/// The program does not read glTF files, which are written for viewers.
bool readable(const std::filesystem::path& path) {
  return path.extension() != ".glb";
}

FileAnswer on_files(const Repair& repair, const FileBench& bench) {
  need_mesh_extension(repair.out);
  need_folder_of(repair.out);
  const Mended made = mended(repair, repair.path, bench.progress("repair"), bench.timings);
  const brep::Triangles& read = made.read;
  const brep::Repair& repaired = made.repaired;
  if (repaired.surface.faces.empty())
    throw std::runtime_error(repair.path.string() + ": no triangle remains, so nothing is written");
  const auto timed = [&](const char* stage, const auto& run) {
    const Stopwatch watch(bench.timings, stage);
    return run();
  };
  const brep::Health before = timed("health", [&] { return brep::health(without_wild_points(read)); });
  Outputs outputs;
  brep::Health after;
  outputs.write(repair.out, [&](const std::filesystem::path& file) {
    write_surface(brep::mesh_of(repaired.surface), file, bench.timings);
    // The health of the written file, which may differ, because formats round points and some do not store
    // which triangles share a point.
    after = timed("health", [&] {
      return readable(file) ? brep::health(brep::read_triangles(file)) : brep::health(repaired.surface);
    });
  });
  outputs.commit();
  const brep::KnownSolids solids{.before = before.solid(),
                                 .after = after.solid() || brep::health(repaired.surface).solid()};
  const brep::RepairEffect effect =
      timed("effect", [&] { return brep::repair_effect(read, repaired.surface, solids); });
  FileAnswer answer;
  for (const brep::Change& left : repaired.left) answer.findings.push_back(left.step + ": " + left.what);
  add_lost_sheets(made, effect, answer.findings);
  if (!after.solid() && solids.after)
    answer.findings.push_back("the surface is a solid, but after rounding for " +
                              repair.out.extension().string() +
                              " it is not: write .ply, .off or .vtp instead");
  answer.json = {{"path", repair.out.string()}};
  answer.json.update(told(made, effect, solids));
  answer.json["before"] = to_json(before);
  answer.json["health"] = to_json(after);
  answer.json["findings"] = answer.findings;
  const auto from_to = [](double was, double is, const char* unit) {
    return grouped(was, 1) + " to " + grouped(is, 1) + unit;
  };
  answer.rows = {{"written", repair.out.string()},
                 {"method", repaired.enclosed_cell_mm ? "enclosed anew, cells of " +
                                                            three_figures(*repaired.enclosed_cell_mm) + " mm"
                                                      : "mended"},
                 {"changes", grouped(static_cast<double>(repaired.changes.size()), 0)},
                 {"volume", from_to(effect.volume_before_mm3, effect.volume_after_mm3, " mm\u00b3")},
                 {"area", from_to(effect.area_before_mm2, effect.area_after_mm2, " mm\u00b2")},
                 {"moved", "up to " + three_figures(effect.largest_distance_mm) + " mm"},
                 {"solid", after.solid() ? "yes" : "no: " + after.findings.front()}};
  constexpr std::size_t shown = 20;
  for (std::size_t i = 0; i < std::min(shown, repaired.changes.size()); ++i)
    answer.rows.emplace_back(repaired.changes[i].step, repaired.changes[i].what);
  if (repaired.changes.size() > shown) answer.rows.emplace_back("...", "the rest with --json");
  return answer;
}

}  // namespace

Operation repair_operation() {
  return Describe<Repair>("repair", "Mends a mesh in the requested ways and lists each change.",
                          Makes::Object)
      .takes(field("path", &Repair::path,
                   std::string("A mesh: ") + brep::mesh_formats_read + ", relative to the plan's folder.")
                 .required()
                 .positional("mesh")
                 .a_file())
      .takes(field("frame", &Repair::frame,
                   "Directions of x, y and z in the file: LPS, RAS, or three other letters. It overrides the "
                   "file's statement. Default: the file's statement, or LPS if there is none."))
      .takes(field("unit", &Repair::unit,
                   "The unit of the file's lengths. It overrides the file's statement. Default: the file's "
                   "statement, or mm if there is none.")
                 .one_of({"um", "mm", "cm", "m", "inch", "foot"}))
      .takes(
          field("weld_mm", &Repair::weld_mm, "Joins points up to this distance apart; 0 joins equal points.")
              .from(0.0)
              .to(1e6))
      .takes(field("duplicates", &Repair::duplicates,
                   "Keeps the first of several triangles with the same points."))
      .takes(
          field("orient", &Repair::orient,
                "Turns triangles so that neighbours agree, outer shells face outward and cavities inward."))
      .takes(field("flat", &Repair::flat, "Removes triangles without area."))
      .takes(field("holes", &Repair::holes, "Closes holes."))
      .takes(field("longest_hole_mm", &Repair::longest_hole_mm,
                   "Leaves holes open if their border is longer than this.")
                 .greater_than(0.0))
      .takes(field("intersections", &Repair::intersections,
                   "Removes triangles that intersect, and closes the gaps. This moves the surface there."))
      .takes(field("solid", &Repair::solid,
                   "Makes a closed solid of any surface by all repairs above. If the result is not a solid, "
                   "builds a new surface around the region that the triangles wind around."))
      .takes(field("cell_mm", &Repair::cell_mm,
                   "For a surface that is built anew: the edge of its cells. Default: the mean side of the "
                   "triangles.")
                 .greater_than(0.0))
      .takes(field(
          "hull", &Repair::hull,
          "For a surface that is built anew: keeps only the outermost shells, so that cavities are filled."))
      .takes(field("wall_mm", &Repair::wall_mm,
                   "Makes a wall of this thickness of the unchanged surface, with its holes; for sheets, "
                   "which enclose nothing.")
                 .greater_than(0.0))
      .takes(field("max_volume_share", &Repair::max_volume_share,
                   "The largest share of the volume that may be gained or lost where triangles intersect. If "
                   "more would change, the repair is refused.")
                 .greater_than(0.0))
      .verb_takes(
          field("out", &Repair::out, "The file of the repaired mesh: .stl, .ply, .obj, .off, .vtp or .glb.")
              .required())
      .example(R"({"id": "plate", "do": "repair", "path": "plate.stl", "weld_mm": 0.001, "holes": true})")
      .on_files(
          "octotomy repair scan.stl --solid -o solid.ply\n"
          "  octotomy repair scan.stl --weld 0.001 --duplicates --flat --orient --holes -o mended.ply",
          on_files)
      .check(check)
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
