// SPDX-License-Identifier: AGPL-3.0-or-later
// An object without its cavities.
#include <limits>

#include "convert/surface/fill_cavities.h"
#include "planner/operation/object/parts.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/witness.h"
#include "voxel/filter/morphology.h"

namespace octotomy::planner {
namespace {

struct Fill {
  ObjectName object;
};

std::string definition(const Fill& fill, const Objects&) {
  return fill.object.name + " without cavities";
}

void voxels(const Fill& fill, const VoxelBench& bench, VoxelSide& made) {
  const VoxelSide& object = bench.object(fill.object.name);
  made.octree = voxel::fill_cavities(object.octree);
  made.symbol = symbol_of_filled(*object.symbol, object.octree, made.octree);
  made.lineage = "voxels that no path of face neighbours connects with the outside";
}

void triangles(const Fill& fill, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "components");
  convert::FilledCavities filled =
      convert::fill_cavities(bench.object(fill.object.name), std::numeric_limits<double>::infinity());
  made.details = {{"cavities", filled.cavities}, {"filled_mm3", filled.volume_mm3}};
  made.whole = filled.solid;
  made.lineage = "the mesh without the shells of cavities";
}

void bound(const Fill& fill, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(fill.object.name);
  inherit(object, made);
  made.witness = verify::witness_of_filled(object.witness);
  made.shown = object.shown;
}

}  // namespace

Operation fill_operation() {
  return Describe<Fill>("fill", "Fills an object's cavities.", Makes::Object)
      .takes(field("object", &Fill::object, "The object.").required().positional("solid"))
      .example(R"({"id": "full", "do": "fill", "object": "skull"})")
      .on_files("octotomy fill skull.stl -o full.stl")
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
