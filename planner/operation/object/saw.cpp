// SPDX-License-Identifier: AGPL-3.0-or-later
// A saw cut: a polyline swept in one direction, as wide as the blade.
#include "brep/shape/saw.h"

#include "brep/boolean/boolean.h"
#include "brep/mesh/components.h"
#include "brep/mesh/error.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/witness.h"
#include "voxel/solid/saw_blade.h"

namespace octotomy::planner {
namespace {

struct Saw {
  ObjectName object;
  std::vector<glm::dvec3> line_mm;
  glm::dvec3 direction{0, 1, 0};
  double depth_mm = 100.0;
  double kerf_mm = 1.0;
};

brep::SawCut cut_of(const Saw& saw) {
  return {saw.line_mm, saw.direction, saw.depth_mm, saw.kerf_mm};
}

void check(const Saw& saw, const FieldLocation& place) {
  try {
    brep::saw_blade(cut_of(saw));
  } catch (const brep::InvalidInput& error) {
    place.refuse(error.what());
  }
}

std::string definition(const Saw& saw, const Objects&) {
  return saw.object.name + " sawn along " + std::to_string(saw.line_mm.size()) + " points, kerf " +
         plain(saw.kerf_mm) + " mm, depth " + plain(saw.depth_mm) + " mm";
}

void voxels(const Saw& saw, const VoxelBench& bench, VoxelSide& made) {
  const voxel::Expression blade = voxel::saw_blade({saw.line_mm, saw.direction, saw.depth_mm, saw.kerf_mm});
  const VoxelSide& object = bench.object(saw.object.name);
  made.octree = bench.combined(voxel::Expression(object.octree) - blade);
  made.symbol = bench.within_universe(*object.symbol - blade);
  made.lineage = "voxel centres outside of the blade";
}

void triangles(const Saw& saw, const MeshBench& bench, MeshSide& made) {
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

void bound(const Saw& saw, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(saw.object.name);
  inherit(object, made);
  made.shown = object.shown;
  made.witness = verify::without(
      object.witness, verify::witness_of_blade({saw.line_mm, saw.direction, saw.depth_mm, saw.kerf_mm}));
  made.ends_with_universe = true;
  const std::vector<CutPlane> sides =
      planes_of(voxel::saw_blade_sides({saw.line_mm, saw.direction, saw.depth_mm, saw.kerf_mm}));
  made.bound.planes.insert(made.bound.planes.end(), sides.begin(), sides.end());
}

}  // namespace

Operation saw_operation() {
  return Describe<Saw>("saw", "Cuts an object along a line swept in one direction, as wide as the saw.",
                       Makes::Object)
      .takes(field("object", &Saw::object, "The object that is cut.").required().positional("solid"))
      .takes(field("line_mm", &Saw::line_mm, "Two or more points of the line, LPS.").required().from(2))
      .takes(field("direction", &Saw::direction, "The direction in which the blade goes in, LPS.")
                 .required()
                 .direction())
      .takes(field("depth_mm", &Saw::depth_mm,
                   "The depth of the cut, from the first point of the line that the blade meets.")
                 .greater_than(0.0))
      .takes(field("kerf_mm", &Saw::kerf_mm, "The width of what is sawn away.").greater_than(0.0))
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
