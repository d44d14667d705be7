// SPDX-License-Identifier: AGPL-3.0-or-later
// An object's surface without its noise. Only the mesh kernel smooths: its answer is voxelised, so that later
// steps find it in both kernels. Its certificate compares it with the same steps by other code.
#include "brep/shape/smooth.h"

#include <algorithm>

#include "brep/mesh/measure.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/object/reshape_file.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/reshaped_witness.h"

namespace octotomy::planner {
namespace {

struct Smooth {
  ObjectName object;
  int rounds = brep::SmoothOptions{}.rounds;
  double pass_band = brep::SmoothOptions{}.pass_band;
  double max_volume_share = brep::SmoothOptions{}.max_volume_share;
  // Of the verb.
  std::filesystem::path out;
  std::optional<double> voxel_mm;
  bool mend = false;
};

/// An upper bound in mm of the distance between both surfaces, in either direction. Smoothing moves points
/// but keeps triangles, so every point of a triangle moves by at most the largest movement of its corners.
double largest_move_mm(const brep::Mesh& mesh, const brep::Mesh& smoothed) {
  const std::vector<glm::dvec3> before = brep::triangles_of(mesh).points_mm,
                                after = brep::triangles_of(smoothed).points_mm;
  double largest_mm = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i)
    largest_mm = std::max(largest_mm, glm::distance(before[i], after[i]));
  return largest_mm;
}

brep::Mesh smoothed(const Smooth& smooth, const brep::Mesh& mesh, Json& details) {
  brep::Mesh made = brep::smooth(mesh, {smooth.rounds, smooth.pass_band, smooth.max_volume_share});
  details["volume_change_mm3"] = brep::volume_mm3(made) - brep::volume_mm3(mesh);
  details["largest_move_mm"] = largest_move_mm(mesh, made);
  return made;
}

std::string definition(const Smooth& smooth, const Objects&) {
  return smooth.object.name + " smoothed in " + std::to_string(smooth.rounds) + " rounds";
}

void triangles(const Smooth& smooth, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "smooth");
  const brep::Solid& solid = bench.object(smooth.object.name);
  made.whole = brep::trusted_solid(smoothed(smooth, solid, made.details), brep::Proof::Connection);
  made.lineage = "alternating steps that shrink and inflate the mesh (Taubin 1995)";
}

void bound(const Smooth& smooth, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(smooth.object.name);
  made.bound.shift_mm = object.bound.shift_mm;
  if (made.mesh.whole && object.mesh.whole)
    made.witness = verify::witness_of_reshaped([still = *object.mesh.whole, smooth]() -> verify::Reshaped {
      return {verify::surface_smoothed(still.triangles(), smooth.rounds, smooth.pass_band)};
    });
  made.bound.reshaped = {smooth.object.name};
  made.ends_with_universe = true;
}

FileAnswer on_files(const Smooth& asked, const FileBench& bench) {
  return reshaped_file({asked.object.name, asked.out, asked.voxel_mm, asked.mend}, bench, "smooth",
                       [&](const brep::Mesh& mesh, Json& details, std::vector<std::string>&) {
                         return smoothed(asked, mesh, details);
                       });
}

}  // namespace

Operation smooth_operation() {
  return Describe<Smooth>("smooth", "Removes noise from an object's surface without changing its volume.",
                          Makes::Object)
      .takes(field("object", &Smooth::object, "The object.").required().positional("mesh"))
      .takes(field("rounds", &Smooth::rounds, "Number of rounds; each is a step inward and a step outward.")
                 .from(1)
                 .to(1000))
      .takes(field("pass_band", &Smooth::pass_band,
                   "Waves of the surface below this frequency are preserved: 0.1 preserves waves longer than "
                   "about 10 edges.")
                 .from(0.001)
                 .to(0.999))
      .takes(field("max_volume_share", &Smooth::max_volume_share,
                   "The largest share of the volume that may be gained or lost. If more would change, the "
                   "step is refused.")
                 .greater_than(0.0))
      .verb_takes(field("out", &Smooth::out,
                        "The file of the smoothed surface: .stl, .ply, .obj, .off, .vtp or .glb; or an "
                        ".octree of the voxels inside it.")
                      .required())
      .verb_takes(field("voxel_mm", &Smooth::voxel_mm,
                        "Edge of an octree's voxels. Default: a 128th of the smoothed surface's extent.")
                      .greater_than(0.0))
      .verb_takes(field("mend", &Smooth::mend,
                        "Mends a mesh that is not a solid first, as repair --solid does. Default: an open "
                        "mesh stays open."))
      .example(R"({"id": "even", "do": "smooth", "object": "skull", "rounds": 10})")
      .on_files("octotomy smooth skull.stl -o smooth.stl --rounds 10 --json", on_files)
      .object(definition, nullptr, triangles, bound);
}

}  // namespace octotomy::planner
