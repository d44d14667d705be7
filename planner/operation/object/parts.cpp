// SPDX-License-Identifier: AGPL-3.0-or-later
// The connected parts of an object that are large enough or contain a point.
#include "planner/operation/object/parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brep/boolean/boolean.h"
#include "brep/mesh/components.h"
#include "brep/mesh/distance.h"
#include "brep/shape/prism.h"
#include "planner/operation/object/part_choice.h"
#include "planner/operation/object/provenance.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "verify/witness/witness.h"
#include "voxel/filter/components.h"
#include "voxel/filter/morphology.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

std::vector<voxel::Box> cubes_about(const std::vector<glm::dvec3>& points_mm, double edge_mm) {
  std::vector<voxel::Box> cubes;
  for (const glm::dvec3& p_mm : points_mm) cubes.push_back({p_mm - 0.5 * edge_mm, p_mm + 0.5 * edge_mm});
  return cubes;
}

brep::Solid solid_of(const voxel::Box& box) {
  const glm::dvec3 a = box.low_mm, b = box.high_mm;
  return brep::solid_of(brep::Prism{
      {0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {{{a.x, a.z}, {b.x, a.z}, {b.x, b.z}, {a.x, b.z}}}, a.y, b.y});
}

}  // namespace

std::vector<glm::dvec3> BridgeDecisions::decided_mm() const {
  std::vector<glm::dvec3> all = keep_mm;
  all.insert(all.end(), cut_mm.begin(), cut_mm.end());
  return all;
}

void check(const BridgeDecisions& bridges, const FieldLocation& place) {
  for (const glm::dvec3& p_mm : bridges.cut_mm)
    if (std::find(bridges.keep_mm.begin(), bridges.keep_mm.end(), p_mm) != bridges.keep_mm.end())
      place.refuse("'keep_bridges_mm' and 'cut_bridges_mm' both have (" + plain(p_mm.x) + ", " +
                   plain(p_mm.y) + ", " + plain(p_mm.z) + "): delete it from one of the two");
}

voxel::Expression cut_bridges(voxel::Expression symbol, const BridgeDecisions& bridges) {
  for (const voxel::Box& cube : cubes_about(bridges.cut_mm, bridges.edge_mm))
    symbol = symbol - voxel::Expression(cube);
  return symbol;
}

voxel::Octree cut_bridges(const voxel::Octree& whole, const BridgeDecisions& bridges) {
  return bridges.cut_mm.empty()
             ? whole
             : voxel::combine(whole.universe(), cut_bridges(voxel::Expression(whole), bridges));
}

brep::Solid cut_bridges(brep::Solid whole, const BridgeDecisions& bridges, const std::stop_token& stop,
                        double& shift_mm) {
  for (const voxel::Box& cube : cubes_about(bridges.cut_mm, bridges.edge_mm)) {
    brep::BooleanResult cut = brep::boolean(whole, brep::Operation::Difference, solid_of(cube), stop);
    whole = std::move(cut.solid);
    shift_mm += cut.shift_mm;
  }
  return whole;
}

verify::Witness cut_bridges(verify::Witness whole, const BridgeDecisions& bridges) {
  for (const voxel::Box& cube : cubes_about(bridges.cut_mm, bridges.edge_mm))
    whole = verify::without(std::move(whole), verify::witness_of_box(cube));
  return whole;
}

voxel::Octree with_kept_parts(const voxel::Octree& chosen, const voxel::Octree& whole,
                              const BridgeDecisions& bridges, voxel::Neighbours neighbours) {
  voxel::Octree all = chosen;
  for (const voxel::Box& cube : cubes_about(bridges.keep_mm, bridges.edge_mm)) {
    const voxel::Octree reached = voxel::combine(whole.universe(), voxel::Expression(cube));
    all = voxel::combine(
        whole.universe(),
        voxel::Expression(all) | voxel::Expression(voxel::components_that_meet(whole, reached, neighbours)));
  }
  std::vector<glm::ivec3> seeds;
  for (const glm::dvec3& p_mm : bridges.agreed_mm) {
    const glm::ivec3 seed(glm::round(whole.universe().lattice().voxel(p_mm)));
    if (glm::all(glm::greaterThanEqual(seed, glm::ivec3(0))) &&
        glm::all(glm::lessThan(seed, glm::ivec3(whole.universe().side()))) && whole.contains(seed))
      seeds.push_back(seed);
  }
  if (seeds.empty()) return all;
  return voxel::combine(whole.universe(), voxel::Expression(all) | voxel::Expression(voxel::components_at(
                                                                       whole, seeds, neighbours)));
}

voxel::Octree largest_parts(const voxel::Octree& whole, std::size_t count, voxel::Neighbours neighbours) {
  const voxel::Components parts = voxel::components(whole, neighbours);
  const std::vector<std::uint64_t>& counts = parts.voxel_counts;
  if (count >= counts.size()) return whole;
  if (count == 1) return parts.largest;
  const std::uint64_t last = counts[count - 1];
  voxel::Octree chosen = voxel::components_of_at_least(whole, last, neighbours);
  constexpr std::size_t most_chosen = 64;
  const auto wanted = static_cast<std::size_t>(
      std::count(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(count), last));
  if (counts[count] < last || wanted > most_chosen) return chosen;
  const voxel::Universe universe = whole.universe();
  const voxel::Octree larger = voxel::components_of_at_least(whole, last + 1, neighbours);
  voxel::Octree equal = voxel::combine(universe, voxel::Expression(chosen) - voxel::Expression(larger));
  chosen = larger;
  for (std::size_t i = 0; i < wanted; ++i) {
    const voxel::Octree first = voxel::components(equal, neighbours).largest;
    chosen = voxel::combine(universe, voxel::Expression(chosen) | voxel::Expression(first));
    equal = voxel::combine(universe, voxel::Expression(equal) - voxel::Expression(first));
  }
  return chosen;
}

bool stays(const brep::Triangles& triangles, const std::vector<std::uint32_t>& faces,
           const BridgeDecisions& bridges) {
  if (!bridges.keeps()) return false;
  const std::vector<voxel::Box> cubes = cubes_about(bridges.keep_mm, bridges.edge_mm);
  const auto holds = [](const voxel::Box& box, const glm::dvec3& p_mm) {
    return glm::all(glm::greaterThanEqual(p_mm, box.low_mm)) &&
           glm::all(glm::lessThanEqual(p_mm, box.high_mm));
  };
  voxel::Box extent{glm::dvec3(std::numeric_limits<double>::infinity()),
                    glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (const std::uint32_t face : faces)
    for (const std::uint32_t corner : triangles.faces[face]) {
      const glm::dvec3& p_mm = triangles.points_mm[corner];
      if (std::any_of(cubes.begin(), cubes.end(), [&](const voxel::Box& cube) { return holds(cube, p_mm); }))
        return true;
      extent = {glm::min(extent.low_mm, p_mm), glm::max(extent.high_mm, p_mm)};
    }
  std::optional<brep::Triangles> part;
  return std::any_of(bridges.agreed_mm.begin(), bridges.agreed_mm.end(), [&](const glm::dvec3& p_mm) {
    if (!holds(extent, p_mm)) return false;
    if (!part) {
      part.emplace(brep::Triangles{triangles.points_mm, {}});
      for (const std::uint32_t face : faces) part->faces.push_back(triangles.faces[face]);
    }
    return brep::is_inside(p_mm, *part);
  });
}

namespace {

struct Parts {
  ObjectName object;
  std::optional<int> largest;
  std::optional<double> at_least_mm3;
  std::vector<Mark> at_mm;
  std::vector<glm::dvec3> keep_bridges_mm, cut_bridges_mm;  ///< as BridgeDecisions
  double bridge_mm = 5.0;
  std::vector<glm::dvec3> agreed_mm;  ///< as BridgeDecisions
};

BridgeDecisions bridges_of(const Parts& parts) {
  return {parts.keep_bridges_mm, parts.cut_bridges_mm, parts.bridge_mm, parts.agreed_mm};
}

std::optional<Parts> with_parts(const Parts& parts, const std::vector<glm::dvec3>& also_mm) {
  Parts more = parts;
  more.agreed_mm.insert(more.agreed_mm.end(), also_mm.begin(), also_mm.end());
  return more;
}

void check(const Parts& parts, const FieldLocation& place) {
  if (int{parts.largest.has_value()} + int{parts.at_least_mm3.has_value()} + int{!parts.at_mm.empty()} != 1)
    place.refuse(
        "needs one of 'largest' (a number of parts), 'at_least_mm3' (a volume) and 'at_mm' (points)");
  check(bridges_of(parts), place);
}

std::string definition(const Parts& parts, const Objects&) {
  if (!parts.at_mm.empty())
    return "the parts of " + parts.object.name + " that hold " + std::to_string(parts.at_mm.size()) +
           (parts.at_mm.size() == 1 ? " point" : " points");
  return parts.largest
             ? "the " + std::to_string(*parts.largest) + " largest parts of " + parts.object.name
             : "parts of " + parts.object.name + " of at least " + plain(*parts.at_least_mm3) + " mm\u00b3";
}

[[noreturn]] void refuse_point(const Parts& parts, const glm::dvec3& p_mm) {
  throw std::runtime_error("no part of '" + parts.object.name + "' holds (" + plain(p_mm.x) + ", " +
                           plain(p_mm.y) + ", " + plain(p_mm.z) + ") mm: choose a point within a part");
}

voxel::Octree parts_at(const Parts& parts, const voxel::Octree& octree, const Objects& objects) {
  const glm::dmat4 voxel_from_lps = glm::inverse(octree.universe().lps_from_voxel);
  std::vector<glm::ivec3> seeds;
  for (const Mark& mark : parts.at_mm) {
    const glm::dvec3 p_mm = mark_mm(mark, objects);
    const glm::ivec3 seed(glm::round(glm::dvec3(voxel_from_lps * glm::dvec4(p_mm, 1.0))));
    const bool is_within = glm::all(glm::greaterThanEqual(seed, glm::ivec3(0))) &&
                           glm::all(glm::lessThan(seed, glm::ivec3(octree.universe().side())));
    if (!is_within || !octree.contains(seed)) refuse_point(parts, p_mm);
    seeds.push_back(seed);
  }
  return voxel::components_at(octree, seeds);
}

void voxels(const Parts& parts, const VoxelBench& bench, VoxelSide& made) {
  const VoxelSide& object = bench.object(parts.object.name);
  const BridgeDecisions bridges = bridges_of(parts);
  const voxel::Octree whole = cut_bridges(object.octree, bridges);
  const auto choose = [&](const voxel::Octree& chosen) {
    made.octree = with_kept_parts(chosen, whole, bridges, voxel::Neighbours::Faces);
    made.symbol = symbol_of_parts(cut_bridges(*object.symbol, bridges), whole, made.octree);
    made.lineage = "voxels that touch by faces";
  };
  if (!parts.at_mm.empty()) return choose(parts_at(parts, whole, bench.objects));
  if (whole.is_empty()) throw std::runtime_error("'" + parts.object.name + "' is empty, so it has no parts");
  if (parts.largest) return choose(largest_parts(whole, static_cast<std::size_t>(*parts.largest)));
  const double voxel_mm3 = bench.universe.lattice().voxel_mm3();
  const voxel::Octree chosen = voxel::components_of_at_least(
      whole, static_cast<std::uint64_t>(std::ceil(*parts.at_least_mm3 / voxel_mm3)));
  if (chosen.is_empty())
    throw std::runtime_error(
        "no part of '" + parts.object.name + "' has " + plain(*parts.at_least_mm3) +
        " mm\u00b3: the largest has " +
        plain(static_cast<double>(voxel::components(whole).voxel_counts[0]) * voxel_mm3));
  choose(chosen);
}

KeptParts kept_parts_at(const Parts& parts, const brep::Solid& solid, const Objects& objects) {
  const std::vector<brep::Component>& all = solid.components();
  KeptParts kept{{}, {}, 0, all.size()};
  std::vector<std::uint32_t> faces;
  std::vector<bool> holds(parts.at_mm.size(), false);
  for (const brep::Component& part : all) {
    brep::Triangles of_part{solid.triangles().points_mm, {}};
    for (const std::uint32_t face : part.faces) of_part.faces.push_back(solid.triangles().faces[face]);
    bool is_kept = false;
    for (std::size_t i = 0; i < holds.size(); ++i)
      if (brep::is_inside(mark_mm(parts.at_mm[i], objects), of_part)) holds[i] = is_kept = true;
    if (!is_kept && !stays(solid.triangles(), part.faces, bridges_of(parts))) continue;
    faces.insert(faces.end(), part.faces.begin(), part.faces.end());
    ++kept.kept;
  }
  for (std::size_t i = 0; i < holds.size(); ++i)
    if (!holds[i]) refuse_point(parts, mark_mm(parts.at_mm[i], objects));
  std::sort(faces.begin(), faces.end());
  kept.mesh = brep::part_of(solid, faces);
  kept.faces = std::move(faces);
  return kept;
}

void triangles(const Parts& parts, const MeshBench& bench, MeshSide& made) {
  const Stopwatch watch(bench.timings, "components");
  const BridgeDecisions bridges = bridges_of(parts);
  const brep::Solid solid =
      cut_bridges(bench.object(parts.object.name), bridges, bench.progress.stop, made.shift_mm);
  KeptParts kept = parts.at_mm.empty() ? kept_parts(solid, parts.largest, parts.at_least_mm3, bridges)
                                       : kept_parts_at(parts, solid, bench.objects);
  made.details = {{"parts", kept.kept}, {"of", kept.of}};
  made.whole = brep::trusted_solid(kept.mesh, brep::proof_of_part(solid.proof()));
  made.lineage = "triangles that share vertices";
  // Necks that were cut belong neither to the object nor to the omitted parts.
  if (!bridges.cut_mm.empty()) return;
  std::vector<std::uint32_t> others;
  for (std::uint32_t face = 0, next = 0; face < solid.triangles().faces.size(); ++face)
    if (next < kept.faces.size() && kept.faces[next] == face)
      ++next;
    else
      others.push_back(face);
  made.parts_of = {
      parts.object.name,
      others.empty() ? brep::Solid()
                     : brep::trusted_solid(brep::part_of(solid, others), brep::proof_of_part(solid.proof()))};
}

void bound(const Parts& parts, const BoundBench& bench, Object& made) {
  const Object& object = bench.objects.at(parts.object.name);
  inherit(object, made);
  const BridgeDecisions bridges = bridges_of(parts);
  const verify::Witness whole = cut_bridges(object.witness, bridges);
  if ((parts.largest || parts.at_least_mm3) && made.mesh.whole)
    settle_choice({[&] { return cut_bridges(object.voxel.octree, bridges); },
                   [&] {
                     double shift_mm = 0.0;
                     return cut_bridges(*object.mesh.whole, bridges, {}, shift_mm);
                   },
                   whole, static_cast<std::size_t>(parts.largest.value_or(1))},
                  bench.universe, parts.at_least_mm3, made);
  made.witness = made.mesh.whole ? verify::witness_of_parts(
                                       whole, {made.voxel.octree, *made.mesh.whole, bridges.decided_mm(),
                                               bridges.keep_mm, made.bound.spacing_mm})
                                 : verify::witness_of_parts(whole);
  made.shown = object.shown;
}

}  // namespace

KeptParts kept_parts(const brep::Mesh& mesh, std::optional<int> largest, std::optional<double> at_least_mm3,
                     const BridgeDecisions& bridges) {
  const std::vector<brep::Component> all = brep::components(mesh);
  const brep::Triangles triangles = bridges.keeps() ? brep::triangles_of(mesh) : brep::Triangles();
  KeptParts parts{{}, {}, 0, all.size()};
  std::vector<std::uint32_t> faces;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_large = (!largest || i < static_cast<std::size_t>(*largest)) &&
                          (!at_least_mm3 || all[i].volume_mm3 >= *at_least_mm3);
    if (!is_large && !stays(triangles, all[i].faces, bridges)) continue;
    faces.insert(faces.end(), all[i].faces.begin(), all[i].faces.end());
    ++parts.kept;
  }
  std::sort(faces.begin(), faces.end());
  parts.mesh = brep::part_of(mesh, faces);
  parts.faces = std::move(faces);
  return parts;
}

voxel::Expression symbol_of_parts(const voxel::Expression& symbol, const voxel::Octree& object,
                                  const voxel::Octree& parts) {
  // The parts widened by one voxel, without the voxels of other parts.
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
  return Describe<Parts>(
             "parts",
             "Keeps the connected parts of an object that are large enough or contain a stated point.",
             Makes::Object)
      .takes(field("object", &Parts::object, "The object.").required().positional("solid"))
      .takes(field("largest", &Parts::largest, "Keeps this number of the largest parts.").from(1).to(1000000))
      .takes(field("at_least_mm3", &Parts::at_least_mm3, "Keeps the parts of at least this volume.")
                 .greater_than(0.0))
      .takes(field("at_mm", &Parts::at_mm, "Keeps the parts that contain these points, LPS, or landmarks.")
                 .from(1)
                 .in_plans_only())
      .takes(field("keep_bridges_mm", &Parts::keep_bridges_mm,
                   "Keeps the parts beyond thin necks at these points, LPS, which certificates list.")
                 .in_plans_only())
      .takes(field("cut_bridges_mm", &Parts::cut_bridges_mm,
                   "Cuts thin necks at these points, LPS: removes everything in a cube around each point.")
                 .in_plans_only())
      .takes(field("bridge_mm", &Parts::bridge_mm,
                   "Edge of the cube around the point of a kept or cut neck, mm.")
                 .greater_than(0.0)
                 .in_plans_only())
      .example(R"({"id": "bone", "do": "parts", "object": "skull", "largest": 1})")
      .on_files("octotomy parts skull.stl --largest 1 -o bone.stl")
      .check(check)
      .with_parts(with_parts)
      .object(definition, voxels, triangles, bound);
}

}  // namespace octotomy::planner
