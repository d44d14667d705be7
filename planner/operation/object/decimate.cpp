// SPDX-License-Identifier: AGPL-3.0-or-later
// An object's surface of fewer triangles. Only the mesh kernel has triangles: its answer is voxelised. Its
// certificate measures how far it lies from the object's surface, and that from it.
#include "brep/shape/decimate.h"

#include "brep/mesh/measure.h"
#include "planner/operation/object/trace.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/reshaped_witness.h"

namespace octotomy::planner {
namespace {

struct Decimate {
  ObjectName object;
  double max_error_mm = brep::DecimateOptions{}.max_error_mm;
  std::optional<int> faces;
  double max_normal_deviation_deg = brep::DecimateOptions{}.max_normal_deviation_deg;
};

std::string definition(const Decimate& decimate, const Objects&) {
  return decimate.object.name + " of fewer triangles, within " + plain(decimate.max_error_mm) + " mm";
}

void triangles(const Decimate& decimate, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "decimate");
  const brep::Solid& solid = bench.object(decimate.object.name);
  brep::DecimateOptions options;
  options.max_error_mm = decimate.max_error_mm;
  if (decimate.faces) options.faces = static_cast<std::size_t>(*decimate.faces);
  options.max_normal_deviation_deg = decimate.max_normal_deviation_deg;
  brep::Mesh fewer = brep::decimate(solid, options);
  made.details = {{"faces_before", solid.mesh().n_faces()},
                  {"volume_change_mm3", brep::volume_mm3(fewer) - brep::volume_mm3(solid)}};
  made.whole = brep::trusted_solid(fewer, brep::Proof::Construction);
  made.lineage = "edges collapsed within an error";
}

void bound(const Decimate& decimate, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(decimate.object.name);
  made.bound.shift_mm = object.bound.shift_mm;
  if (made.mesh.whole && object.mesh.whole)
    made.witness = verify::witness_of_reshaped([still = *object.mesh.whole, decimate]() -> verify::Reshaped {
      return {verify::surface_decimated(still.triangles(), decimate.max_error_mm)};
    });
  made.bound.reshaped = {decimate.object.name};
  made.ends_with_universe = true;
}

}  // namespace

Operation decimate_operation() {
  return Describe<Decimate>("decimate", "Makes an object's surface of fewer triangles.", Makes::Object)
      .takes(field("object", &Decimate::object, "The object.").required().positional("mesh"))
      .takes(field("max_error_mm", &Decimate::max_error_mm,
                   "Largest distance of a point that stays from the triangles it stands for.")
                 .greater_than(0.0))
      .takes(field("faces", &Decimate::faces, "Ends at so many triangles.").from(4).to(100000000))
      .takes(field("max_normal_deviation_deg", &Decimate::max_normal_deviation_deg,
                   "Largest turn of a triangle at one collapse.")
                 .greater_than(0.0)
                 .to(90.0))
      .example(R"({"id": "light", "do": "decimate", "object": "skull", "max_error_mm": 0.2})")
      .on_files("octotomy decimate skull.stl -o light.stl --max-error 0.2 --json")
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
