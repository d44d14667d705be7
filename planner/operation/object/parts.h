// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/solid.h"
#include "planner/operation/table/object.h"
#include "planner/operation/table/scope.h"
#include "verify/witness/reading.h"
#include "voxel/filter/components.h"
#include "voxel/solid/expression.h"
#include "voxel/space/lattice.h"
#include "voxel/tree/octree.h"

// Choosing connected parts in each kernel, for every operation that does.
namespace octotomy::planner {

/// Necks as points, LPS, each the middle of a cube along the axes.
struct BridgeDecisions {
  std::vector<glm::dvec3> keep_mm;  ///< the parts that reach into the cube stay, whatever their size
  std::vector<glm::dvec3> cut_mm;   ///< the object loses what lies within the cube
  double edge_mm = 5.0;             ///< of the cubes
  /// Points of further parts that stay: those which one kernel alone joins by a neck that is too thin to
  /// measure.
  std::vector<glm::dvec3> agreed_mm = {};

  bool any() const { return !keep_mm.empty() || !cut_mm.empty(); }
  bool keeps() const { return !keep_mm.empty() || !agreed_mm.empty(); }
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

/// The chosen parts and those that stay with them.
voxel::Octree with_kept_parts(const voxel::Octree& chosen, const voxel::Octree& whole,
                              const BridgeDecisions& bridges, voxel::Neighbours neighbours);
/// Whether a part, some of the triangles, stays with the chosen ones. The triangles are not read where no
/// decision keeps anything.
bool stays(const brep::Triangles& triangles, const std::vector<std::uint32_t>& faces,
           const BridgeDecisions& bridges);

/// So many of the largest parts of voxels; of equal ones at the end of the row those whose first voxel comes
/// first, x fastest. Where more than 64 equal ones are to be chosen from, all of them stay. Precondition: the
/// object is not empty, `count` is positive.
voxel::Octree largest_parts(const voxel::Octree& whole, std::size_t count,
                            voxel::Neighbours neighbours = voxel::Neighbours::Faces);

/// The parts that stay, as a mesh.
struct KeptParts {
  brep::Mesh mesh;
  std::vector<std::uint32_t> faces;  ///< of the whole, ascending
  std::size_t kept = 0, of = 0;
};

/// The largest parts of a closed mesh, so many of them and of those the ones of at least a volume, each with
/// its cavities; and the parts that reach a neck which is to be kept.
KeptParts kept_parts(const brep::Mesh& mesh, std::optional<int> largest, std::optional<double> at_least_mm3,
                     const BridgeDecisions& bridges = {});

/// An object that parts are chosen from; both answers are made only where the kernels chose different parts.
struct WholeObject {
  std::function<voxel::Octree()> voxels;
  std::function<brep::Solid()> mesh;
  verify::Witness witness;
};

/// Of parts that are nearly as large as each other chance decides which each kernel finds larger, and of
/// those that are nearly as large as `least_mm3`, which parts reach it; none: the largest ones were chosen.
/// Where the kernels chose different parts, each rightly by its own measure, and hold each other's parts as
/// well (verify::certify_bounded), the mesh takes those of the voxels, with a caveat that names both. Where a
/// kernel chose wrongly, or lacks the other's part, nothing changes: the certificate fails. Cost: that of
/// digitising the mesh; where the choices differ, of two certificates as well. Throws as its functions.
void settle_choice(const WholeObject& whole, const voxel::Universe& universe,
                   const std::optional<double>& least_mm3, Object& made);

/// What an object's symbol becomes where parts were chosen from its voxels: the samples about the parts still
/// say where their surface lies within a voxel, so that a motion samples it there.
voxel::Expression symbol_of_parts(const voxel::Expression& symbol, const voxel::Octree& object,
                                  const voxel::Octree& parts);

/// The same where cavities were filled: the filling reaches into the voxels about it, so that a motion leaves
/// no gap between them and the surface that the samples show.
voxel::Expression symbol_of_filled(const voxel::Expression& symbol, const voxel::Octree& object,
                                   const voxel::Octree& filled);

}  // namespace octotomy::planner
