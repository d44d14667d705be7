// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/bridges.h"

#include <algorithm>

#include "brep/boolean/boolean.h"
#include "brep/shape/prism.h"
#include "planner/table/number_format.h"
#include "verify/witness.h"
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

void check(const BridgeDecisions& bridges, const Place& place) {
  for (const glm::dvec3& p_mm : bridges.cut_mm)
    if (std::find(bridges.keep_mm.begin(), bridges.keep_mm.end(), p_mm) != bridges.keep_mm.end())
      place.refuse("'keep_bridges_mm' and 'cut_bridges_mm' both have (" + plain(p_mm.x) + ", " +
                   plain(p_mm.y) + ", " + plain(p_mm.z) + "): a bridge is kept or cut");
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
  return all;
}

bool reaches_kept_bridge(const brep::Triangles& triangles, const std::vector<std::uint32_t>& faces,
                         const BridgeDecisions& bridges) {
  const std::vector<voxel::Box> cubes = cubes_about(bridges.keep_mm, bridges.edge_mm);
  return std::any_of(cubes.begin(), cubes.end(), [&](const voxel::Box& cube) {
    return std::any_of(faces.begin(), faces.end(), [&](std::uint32_t face) {
      const auto& corners = triangles.faces[face];
      return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
        const glm::dvec3& p = triangles.points_mm[corner];
        return glm::all(glm::greaterThanEqual(p, cube.low_mm)) &&
               glm::all(glm::lessThanEqual(p, cube.high_mm));
      });
    });
  });
}

}  // namespace octotomy::planner
