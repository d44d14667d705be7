// SPDX-License-Identifier: AGPL-3.0-or-later
// A saw cut: a polyline swept in one direction, as wide as the blade.
#include "planner/operation/object/saw.h"

#include "brep/boolean/boolean.h"
#include "brep/mesh/components.h"
#include "brep/mesh/error.h"
#include "brep/shape/saw.h"
#include "planner/operation/file/slicer_markup.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/field_file.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/witness.h"
#include "voxel/solid/saw_blade.h"

namespace octotomy::planner {
namespace {

brep::SawCut cut_of(const Saw& saw) {
  return {saw.line_mm, *saw.direction, saw.depth_mm, saw.kerf_mm};
}

voxel::SawLine line_of(const Saw& saw) {
  return {saw.line_mm, *saw.direction, saw.depth_mm, saw.kerf_mm};
}

void check(const Saw& saw, const FieldLocation& place) {
  if (saw.line_mm.empty() == saw.plane.empty())
    place.at("line_mm").refuse(
        saw.plane.empty() ? "is missing: add it, or 'plane'"
                          : "states the cut a second time, in addition to 'plane': keep one of them");
  if (saw.plane.empty() && !saw.direction) place.at("direction").refuse("is missing: add it");
  if (saw.plane.empty()) {
    try {
      brep::saw_blade(cut_of(saw));
    } catch (const brep::InvalidInput& error) {
      place.refuse(error.what());
    }
    return;
  }
  check_field_file(place.at("plane"), saw.plane, [&](const std::filesystem::path&) {
    brep::saw_blade(cut_of(with_plane_read(saw, place.scope->folder())));
  });
}

std::string definition(const Saw& saw, const Objects&) {
  if (!saw.plane.empty())
    return saw.object.name + " sawn along the plane of " + saw.plane.filename().string() + ", kerf " +
           plain(saw.kerf_mm) + " mm";
  return saw.object.name + " sawn along " + std::to_string(saw.line_mm.size()) + " points, kerf " +
         plain(saw.kerf_mm) + " mm, depth " + plain(saw.depth_mm) + " mm";
}

void voxels(const Saw& typed, const VoxelBench& bench, VoxelSide& made) {
  const Saw saw = with_plane_read(typed, bench.folder, made.findings);
  const voxel::Expression blade = voxel::saw_blade(line_of(saw));
  const VoxelSide& object = bench.object(saw.object.name);
  made.octree = bench.combined(voxel::Expression(object.octree) - blade);
  made.symbol = bench.within_universe(*object.symbol - blade);
  made.lineage = "voxel centres outside of the blade";
}

void triangles(const Saw& typed, const MeshBench& bench, MeshSide& made) {
  const Saw saw = with_plane_read(typed, bench.folder);
  const Stopwatch watch(bench.timings, "boolean_mesh");
  const brep::Solid& solid = bench.object(saw.object.name);
  brep::BooleanResult rest =
      brep::boolean(solid, brep::Operation::Difference, brep::saw_blade(cut_of(saw)), bench.progress.stop);
  made.shift_mm = rest.shift_mm;
  made.findings = rest.findings;
  made.details["residuals"] = {
      {"volume_relative", rest.residual ? nlohmann::ordered_json(*rest.residual) : nullptr}};
  made.details["sawn_away_mm3"] = brep::volume_mm3(solid) - brep::volume_mm3(rest.solid);
  made.details["pieces"] = nlohmann::ordered_json::array();
  for (const brep::Component& piece : brep::components(rest.solid))
    made.details["pieces"].push_back({{"volume_mm3", piece.volume_mm3}, {"area_mm2", piece.area_mm2}});
  made.whole = rest.solid;
  made.lineage = "corefinement with the blade's mesh";
}

void bound(const Saw& typed, const BoundBench& bench, Object& made) {
  std::vector<std::string> findings;
  const Saw saw = with_plane_read(typed, bench.folder, findings);
  if (!saw.plane.empty()) made.shared_values.push_back("the plane in " + saw.plane.filename().string());
  for (const std::string& finding : findings)
    if (finding.find(": WARN, ") != std::string::npos)
      made.caveats.push_back({voxel::Verdict::Warn, finding});
  const Object& object = bench.objects.at(saw.object.name);
  inherit(object, made);
  made.shown = object.shown;
  made.witness = verify::without(
      object.witness, verify::witness_of_blade({saw.line_mm, *saw.direction, saw.depth_mm, saw.kerf_mm}));
  made.ends_with_universe = true;
  const std::vector<CutPlane> sides = planes_of(voxel::saw_blade_sides(line_of(saw)));
  made.bound.planes.insert(made.bound.planes.end(), sides.begin(), sides.end());
}

}  // namespace

Saw with_plane_read(const Saw& saw, const std::filesystem::path& folder, std::vector<std::string>& findings) {
  if (saw.plane.empty()) return saw;
  const MarkupPlane plane = read_plane(folder / saw.plane, findings);
  if (!plane.low_mm)
    throw std::runtime_error(
        saw.plane.string() +
        ": the plane states no bounds, so the saw's depth is unknown: set the plane's size in Slicer");
  const glm::dvec2 low = *plane.low_mm, high = *plane.high_mm;
  Saw read = saw;
  const glm::dvec3 entry_mm = plane.origin_mm + low.y * plane.up;
  read.line_mm = {entry_mm + low.x * plane.right, entry_mm + high.x * plane.right};
  read.direction = plane.up;
  read.depth_mm = high.y - low.y;
  return read;
}

Saw with_plane_read(const Saw& saw, const std::filesystem::path& folder) {
  std::vector<std::string> findings;
  return with_plane_read(saw, folder, findings);
}

Operation saw_operation() {
  const char* const of_plane = "is determined by 'plane': leave it out";
  return Describe<Saw>("saw",
                       "Cuts an object by a saw of some width that moves along a line and in one direction.",
                       Makes::Object)
      .takes(field("object", &Saw::object, "The object that is cut.").required().positional("solid"))
      .takes(field("line_mm", &Saw::line_mm, "Two or more points of the line, LPS.").from(2))
      .takes(field("direction", &Saw::direction, "The direction in which the blade enters, LPS.")
                 .direction()
                 .read_if<Saw>([](const Saw& saw) { return saw.plane.empty(); }, of_plane))
      .takes(field("depth_mm", &Saw::depth_mm,
                   "The depth of the cut along the direction, from the point of the line that the blade "
                   "reaches first.")
                 .greater_than(0.0)
                 .read_if<Saw>([](const Saw& saw) { return saw.plane.empty(); }, of_plane))
      .takes(field("kerf_mm", &Saw::kerf_mm, "The width of the cut.").greater_than(0.0))
      .takes(field("plane", &Saw::plane,
                   "A plane of 3D Slicer, .mrk.json, instead of line, direction and depth. The blade enters "
                   "along the plane's second axis and crosses its rectangle.")
                 .a_file())
      .example(
          R"({"id": "sawn", "do": "saw", "object": "skull", "line_mm": [[-60, -120, -20], [60, -120, -20]],
        "direction": [0, 1, 0], "depth_mm": 80, "kerf_mm": 0.8})")
      .on_files(
          "octotomy saw skull.stl --line -60,-120,-20 60,-120,-20 --direction 0,1,0 --depth 80 "
          "--kerf 0.8 -o cut.stl")
      .check(check)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
