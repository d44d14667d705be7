// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/solid.h"
#include "planner/operation/table/scope.h"
#include "verify/witness/reading.h"
#include "voxel/filter/components.h"
#include "voxel/solid/expression.h"
#include "voxel/space/lattice.h"
#include "voxel/tree/octree.h"

// Selects connected parts in each kernel. Every operation that selects parts uses these functions.
namespace octotomy::planner {

/// Decisions on thin necks between parts. A neck is stated by a point, LPS: the centre of a cube along the
/// axes.
struct BridgeDecisions {
  std::vector<glm::dvec3> keep_mm;  ///< parts that reach into the cube stay, even small ones
  std::vector<glm::dvec3> cut_mm;   ///< the object's part within the cube is removed
  double edge_mm = 5.0;             ///< of the cubes
  /// Points of further parts that stay: parts that only one of the kernels connects, by a neck that is too
  /// thin to be measured.
  std::vector<glm::dvec3> agreed_mm = {};

  bool any() const { return !keep_mm.empty() || !cut_mm.empty(); }
  bool keeps() const { return !keep_mm.empty() || !agreed_mm.empty(); }
  /// The points of all necks that are kept or cut.
  std::vector<glm::dvec3> decided_mm() const;
};

/// Refuses a point that is both in `keep_mm` and in `cut_mm`.
void check(const BridgeDecisions& bridges, const FieldLocation& place);

/// The object without the cubes of cut necks, as voxels, expression, solid or witness.
voxel::Octree cut_bridges(const voxel::Octree& whole, const BridgeDecisions& bridges);
voxel::Expression cut_bridges(voxel::Expression symbol, const BridgeDecisions& bridges);
/// Adds the distance by which operands were moved to `shift_mm`. Throws as brep::boolean().
brep::Solid cut_bridges(brep::Solid whole, const BridgeDecisions& bridges, const std::stop_token& stop,
                        double& shift_mm);
verify::Witness cut_bridges(verify::Witness whole, const BridgeDecisions& bridges);

/// The chosen parts and the parts of `whole` that the decisions keep.
voxel::Octree with_kept_parts(const voxel::Octree& chosen, const voxel::Octree& whole,
                              const BridgeDecisions& bridges, voxel::Neighbours neighbours);
/// Whether the decisions keep a part, which is stated by the indices of its triangles. `triangles` is read
/// only if the decisions keep any part.
bool stays(const brep::Triangles& triangles, const std::vector<std::uint32_t>& faces,
           const BridgeDecisions& bridges);

/// The `count` largest parts of voxels. If several parts have the size of the last one, those with the lowest
/// first voxel, x fastest, are selected; if more than 64 of these would be needed, all of them. Precondition:
/// the object is not empty, and `count` is positive.
voxel::Octree largest_parts(const voxel::Octree& whole, std::size_t count,
                            voxel::Neighbours neighbours = voxel::Neighbours::Faces);

/// The parts that stay, as a mesh, with their triangles in the whole mesh, their number, and the number of
/// all parts.
struct KeptParts {
  brep::Mesh mesh;
  std::vector<std::uint32_t> faces;  ///< of the whole, ascending
  std::size_t kept = 0, of = 0;
};

/// The parts of a closed mesh that are among the `largest` largest and have at least the volume, each with
/// its cavities; and also the parts that the decisions keep.
KeptParts kept_parts(const brep::Mesh& mesh, std::optional<int> largest, std::optional<double> at_least_mm3,
                     const BridgeDecisions& bridges = {});

/// The expression of selected parts of an object. It keeps the samples around the parts, because these place
/// the surface within a voxel, and a motion interpolates them.
voxel::Expression symbol_of_parts(const voxel::Expression& symbol, const voxel::Octree& object,
                                  const voxel::Octree& parts);

/// The expression of an object with filled cavities. The filling extends into the voxels around it, so that a
/// motion leaves no gap between the filling and the surface from the samples.
voxel::Expression symbol_of_filled(const voxel::Expression& symbol, const voxel::Octree& object,
                                   const voxel::Octree& filled);

}  // namespace octotomy::planner
