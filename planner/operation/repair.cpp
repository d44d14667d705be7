// SPDX-License-Identifier: AGPL-3.0-or-later
// A mesh of any program, mended in the ways that are asked for, as an object. Its voxels are made of it, so
// that it has no certificate of its own.
#include "brep/shape/repair.h"

#include "brep/io/read_mesh.h"
#include "brep/io/write_mesh.h"
#include "brep/mesh/health.h"
#include "planner/file/mesh_file.h"
#include "planner/measure/result_json.h"
#include "planner/operation/trace.h"
#include "planner/table/number_format.h"
#include "planner/table/operation.h"

namespace octotomy::planner {
namespace {

struct Repair {
  std::filesystem::path path, out;
  std::optional<double> weld_mm, longest_hole_mm;
  bool duplicates = false, orient = false, flat = false, holes = false, intersections = false;
};

void check(const Repair& repair, const Place& place) {
  if (!repair.weld_mm && !repair.duplicates && !repair.orient && !repair.flat && !repair.holes &&
      !repair.intersections)
    place.refuse(
        "does only what it is asked for: say 'weld_mm', 'duplicates', 'flat', 'orient', 'holes' or "
        "'intersections'; octotomy info tells what a mesh lacks");
}

Json to_json(const std::vector<brep::Change>& changes) {
  Json list = Json::array();
  for (const brep::Change& change : changes)
    list.push_back({{"step", change.step}, {"what", change.what}, {"at_mm", planner::to_json(change.at_mm)}});
  return list;
}

/// The surface before and after.
struct Mended {
  brep::Triangles read;
  brep::Repair repaired;
};

Mended mended(const Repair& repair, const std::filesystem::path& path, Timings& timings) {
  Mended made;
  {
    const Stopwatch watch(timings, "read");
    made.read = brep::read_triangles(path);
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
  made.repaired = brep::repair(made.read, options);
  return made;
}

std::string definition(const Repair& repair, const Objects&) {
  return repair.path.filename().string() + ", mended";
}

void triangles(const Repair& repair, const MeshBench& bench, MeshSide& made) {
  const Mended mended_mesh = mended(repair, bench.folder / repair.path, bench.timings);
  const brep::Health health = brep::health(mended_mesh.repaired.surface);
  if (!health.solid())
    throw std::runtime_error(repair.path.string() + ": is still not a solid: " + health.findings.front() +
                             "; ask for more to be mended");
  made.details = {{"changes", to_json(mended_mesh.repaired.changes)},
                  {"left", to_json(mended_mesh.repaired.left)}};
  made.whole = brep::trusted_solid(mended_mesh.repaired.surface, brep::Proof::Construction);
  made.lineage = "triangles of " + repair.path.filename().string() + ", mended";
}

void bound(const Repair&, const BoundBench&, Object&) {}

FileAnswer on_files(const Repair& repair, const FileBench& bench) {
  need_mesh_extension(repair.out);
  need_folder_of(repair.out);
  const auto [read, repaired] = mended(repair, repair.path, bench.timings);
  const brep::Health before = brep::health(read), after = brep::health(repaired.surface);
  write_surface(brep::mesh_of(repaired.surface), repair.out, bench.timings);
  FileAnswer answer;
  for (const brep::Change& left : repaired.left) answer.findings.push_back(left.step + ": " + left.what);
  answer.json = {{"path", repair.out.string()},
                 {"changes", to_json(repaired.changes)},
                 {"left", to_json(repaired.left)},
                 {"before", planner::to_json(before)},
                 {"health", planner::to_json(after)}};
  answer.rows = {{"written", repair.out.string()},
                 {"changes", grouped(static_cast<double>(repaired.changes.size()), 0)},
                 {"solid", after.solid() ? "yes" : "no: " + after.findings.front()}};
  constexpr std::size_t shown = 20;
  for (std::size_t i = 0; i < std::min(shown, repaired.changes.size()); ++i)
    answer.rows.emplace_back(repaired.changes[i].step, repaired.changes[i].what);
  if (repaired.changes.size() > shown) answer.rows.emplace_back("...", "the rest with --json");
  return answer;
}

}  // namespace

Operation repair_operation() {
  return Describe<Repair>("repair", "Mends a mesh in the ways asked for and lists each change.",
                          Makes::Object)
      .takes(field("path", &Repair::path,
                   "A mesh: .stl, .ply, .obj, .off, .vtk or .vtp, relative to the plan's folder.")
                 .required()
                 .positional("mesh")
                 .a_file())
      .takes(field("weld_mm", &Repair::weld_mm,
                   "Points no further apart than this become one; 0 joins equal points.")
                 .from(0.0)
                 .to(1e6))
      .takes(field("duplicates", &Repair::duplicates, "Of triangles with the same points keeps the first."))
      .takes(field("orient", &Repair::orient, "Makes neighbours alike, shells outward, cavities inward."))
      .takes(field("flat", &Repair::flat, "Takes out triangles without area."))
      .takes(field("holes", &Repair::holes, "Closes holes."))
      .takes(field("longest_hole_mm", &Repair::longest_hole_mm, "Leaves holes open whose border is longer.")
                 .greater_than(0.0))
      .takes(field("intersections", &Repair::intersections,
                   "Takes out triangles that intersect and closes what they leave: moves the surface there."))
      .verb_takes(field("out", &Repair::out, "A .stl, .ply, .obj, .off, .vtp or .glb file.").required())
      .example(R"({"id": "plate", "do": "repair", "path": "plate.stl", "weld_mm": 0.001, "holes": true})")
      .on_files("octotomy repair scan.stl --weld 0.001 --duplicates --flat --orient --holes -o mended.ply",
                on_files)
      .check(check)
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
