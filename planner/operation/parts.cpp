// SPDX-License-Identifier: AGPL-3.0-or-later
// The connected parts of an object that are large enough.
#include "planner/operation/parts.h"

#include <algorithm>
#include <cmath>

#include "brep/mesh/components.h"
#include "planner/operation/trace.h"
#include "planner/table/number_format.h"
#include "planner/table/operation.h"
#include "verify/witness.h"
#include "voxel/filter/components.h"
#include "voxel/filter/morphology.h"
#include "voxel/solid/combine.h"

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
  made.symbol = symbol_of_parts(*object.symbol, object.octree, made.octree);
  made.lineage = "voxels that touch by faces";
}

void triangles(const Parts& parts, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "components");
  const brep::Solid& solid = bench.object(parts.object.name);
  KeptParts kept = kept_parts(solid, parts.largest, parts.at_least_mm3);
  made.details = {{"parts", kept.kept}, {"of", kept.of}};
  made.whole = brep::trusted_solid(kept.mesh, brep::proof_of_part(solid.proof()));
  made.lineage = "triangles that share vertices";
}

void bound(const Parts& parts, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(parts.object.name);
  inherit(object, made);
  made.witness = verify::witness_of_parts(object.witness);
  made.shown = object.shown;
}

}  // namespace

KeptParts kept_parts(const brep::Mesh& mesh, std::optional<int> largest, std::optional<double> at_least_mm3) {
  const std::vector<brep::Component> all = brep::components(mesh);
  KeptParts parts{{}, 0, all.size()};
  std::vector<std::uint32_t> faces;
  for (const brep::Component& part : all) {
    if (largest && parts.kept == static_cast<std::size_t>(*largest)) break;
    if (at_least_mm3 && part.volume_mm3 < *at_least_mm3) break;
    faces.insert(faces.end(), part.faces.begin(), part.faces.end());
    ++parts.kept;
  }
  std::sort(faces.begin(), faces.end());
  parts.mesh = brep::part_of(mesh, faces);
  return parts;
}

voxel::Expression symbol_of_parts(const voxel::Expression& symbol, const voxel::Octree& object,
                                  const voxel::Octree& parts) {
  // A voxel's width around the parts, without the voxels of others.
  const double reach_mm = glm::length(parts.universe().lattice().spacing_mm());
  return symbol & (voxel::Expression(voxel::dilate(parts, reach_mm)) -
                   (voxel::Expression(object) - voxel::Expression(parts)));
}

voxel::Expression symbol_of_filled(const voxel::Expression& symbol, const voxel::Octree& object,
                                   const voxel::Octree& filled) {
  const voxel::Universe universe = filled.universe();
  const double reach_mm = glm::length(universe.lattice().spacing_mm());
  const voxel::Octree cavities =
      voxel::combine(universe, voxel::Expression(filled) - voxel::Expression(object));
  if (cavities.is_empty()) return symbol;
  return symbol | (voxel::Expression(voxel::dilate(cavities, reach_mm)) & voxel::Expression(filled));
}

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
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
