// SPDX-License-Identifier: AGPL-3.0-or-later
// The connected parts of an object that are large enough.
#include <algorithm>
#include <cmath>

#include "brep/mesh/components.h"
#include "planner/operation/trace.h"
#include "planner/table/number_format.h"
#include "planner/table/operation.h"
#include "verify/witness.h"
#include "voxel/filter/components.h"
#include "voxel/filter/morphology.h"

namespace octotomy::planner {
namespace {

struct Parts {
  ObjectName object;
  std::optional<int> largest;
  std::optional<double> at_least_mm3;
};

void check(const Parts& parts, const Place& place) {
  if (parts.largest.has_value() == parts.at_least_mm3.has_value())
    place.refuse("needs one of 'largest', a number of parts, and 'at_least_mm3', a volume");
}

std::string definition(const Parts& parts, const Objects&) {
  return parts.largest
             ? "the " + std::to_string(*parts.largest) + " largest parts of " + parts.object.name
             : "parts of " + parts.object.name + " of at least " + plain(*parts.at_least_mm3) + " mm\u00b3";
}

void voxels(const Parts& parts, const VoxelBench& bench, VoxelSide& made) {
  const VoxelSide& object = bench.object(parts.object.name);
  const std::vector<std::uint64_t> counts = voxel::components(object.octree).voxel_counts;
  if (counts.empty()) throw std::runtime_error("'" + parts.object.name + "' is empty: it has no parts");
  const std::size_t wanted = std::min(static_cast<std::size_t>(parts.largest.value_or(1)), counts.size());
  const std::uint64_t least =
      parts.largest
          ? counts[wanted - 1]
          : static_cast<std::uint64_t>(std::ceil(*parts.at_least_mm3 / bench.universe.lattice().voxel_mm3()));
  made.octree = voxel::components_of_at_least(object.octree, least);
  if (made.octree.is_empty())
    throw std::runtime_error("no part of '" + parts.object.name + "' has " + plain(*parts.at_least_mm3) +
                             " mm\u00b3: the largest has " +
                             plain(static_cast<double>(counts[0]) * bench.universe.lattice().voxel_mm3()));
  // The samples about the parts still say where their surface lies within a voxel, so that a motion samples
  // it there: a voxel's width around them, without the voxels of other parts.
  const glm::dvec3 spacing_mm = bench.universe.lattice().spacing_mm();
  const voxel::Expression around = voxel::Expression(voxel::dilate(made.octree, glm::length(spacing_mm))) -
                                   (voxel::Expression(object.octree) - voxel::Expression(made.octree));
  made.symbol = *object.symbol & around;
  made.lineage = "voxels that touch by faces";
}

void triangles(const Parts& parts, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "components");
  const brep::Solid& solid = bench.object(parts.object.name);
  std::vector<brep::Component> all = brep::components(solid);
  std::stable_sort(all.begin(), all.end(), [](const brep::Component& a, const brep::Component& b) {
    return a.volume_mm3 > b.volume_mm3;
  });
  std::vector<std::uint32_t> faces;
  std::size_t kept = 0;
  for (const brep::Component& part : all) {
    if (parts.largest ? kept == static_cast<std::size_t>(*parts.largest)
                      : part.volume_mm3 < *parts.at_least_mm3)
      break;
    faces.insert(faces.end(), part.faces.begin(), part.faces.end());
    ++kept;
  }
  std::sort(faces.begin(), faces.end());
  made.details = {{"parts", kept}, {"of", all.size()}};
  made.whole = brep::trusted_solid(brep::part_of(solid, faces), brep::proof_of_part(solid.proof()));
  made.lineage = "triangles that share vertices";
}

void bound(const Parts& parts, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(parts.object.name);
  inherit(object, made);
  made.witness = verify::witness_of_parts(object.witness);
  made.shown = object.shown;
}

}  // namespace

Operation parts_operation() {
  return Describe<Parts>("parts", "Keeps the connected parts of an object that are large enough.",
                         Makes::Object)
      .takes(field("object", &Parts::object, "The object.").required().positional("solid"))
      .takes(field("largest", &Parts::largest, "Keep this many of the largest parts.").from(1).to(1000000))
      .takes(field("at_least_mm3", &Parts::at_least_mm3, "Keep the parts of at least this volume.")
                 .greater_than(0.0))
      .example(R"({"id": "bone", "do": "parts", "object": "skull", "largest": 1})")
      .on_files("octotomy parts skull.stl --largest 1 -o bone.stl")
      .check(check)
      .definition(definition)
      .voxel(voxels)
      .mesh(triangles)
      .bound(bound);
}

}  // namespace octotomy::planner
