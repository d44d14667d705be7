// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/table/field.h"
#include "verify/reading.h"
#include "voxel/filter/components.h"
#include "voxel/space/lattice.h"
#include "voxel/tree/octree.h"

// Thin necks that a plan decides before connected parts are chosen: where one kernel joins two parts and the
// other does not, both take the plan's word.
namespace octotomy::planner {

/// Necks as points, LPS, each the middle of a cube along the axes.
struct BridgeDecisions {
  std::vector<glm::dvec3> keep_mm;  ///< the parts that reach into the cube stay, whatever their size
  std::vector<glm::dvec3> cut_mm;   ///< the object loses what lies within the cube
  double edge_mm = 5.0;             ///< of the cubes

  bool any() const { return !keep_mm.empty() || !cut_mm.empty(); }
  /// The places of all.
  std::vector<glm::dvec3> decided_mm() const;
};

/// Refuses a point that is to be kept and cut.
void check(const BridgeDecisions& bridges, const Place& place);

/// The object without the cubes of necks that are cut, in each kernel, as a symbol, and as a reading.
voxel::Octree cut_bridges(const voxel::Octree& whole, const BridgeDecisions& bridges);
voxel::Expression cut_bridges(voxel::Expression symbol, const BridgeDecisions& bridges);
/// Adds to `shift_mm` how far operands were moved. Throws as brep::boolean().
brep::Solid cut_bridges(brep::Solid whole, const BridgeDecisions& bridges, const std::stop_token& stop,
                        double& shift_mm);
verify::Witness cut_bridges(verify::Witness whole, const BridgeDecisions& bridges);

/// The chosen parts and those that a neck to be kept joins to them.
voxel::Octree with_kept_parts(const voxel::Octree& chosen, const voxel::Octree& whole,
                              const BridgeDecisions& bridges, voxel::Neighbours neighbours);
/// Whether triangles have a corner within the cube of a neck that is kept.
bool reaches_kept_bridge(const brep::Triangles& triangles, const std::vector<std::uint32_t>& faces,
                         const BridgeDecisions& bridges);

}  // namespace octotomy::planner
