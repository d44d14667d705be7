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

// Selects connected parts in each kernel, for every operation that does so.
namespace octotomy::planner {

/// Decisions on thin necks between parts. Each neck is a point, LPS: the centre of a cube along the axes.
struct BridgeDecisions {
  std::vector<glm::dvec3> keep_mm;  ///< the parts that reach into the cube stay, also small ones
  std::vector<glm::dvec3> cut_mm;   ///< the object loses its part within the cube
  double edge_mm = 5.0;             ///< of the cubes
  /// Points of further parts that stay: parts that only one of the kernels connects, by a neck too thin to
  /// measure.
  std::vector<glm::dvec3> agreed_mm = {};

  bool any() const { return !keep_mm.empty() || !cut_mm.empty(); }
  bool keeps() const { return !keep_mm.empty() || !agreed_mm.empty(); }
  /// The points of all kept and cut necks.
  std::vector<glm::dvec3> decided_mm() const;
};

/// Refuses a point that is listed both as kept and as cut.
void check(const BridgeDecisions& bridges, const FieldLocation& place);

/// The object without the cubes of the cut necks: as voxels, as an expression, as a solid and as a witness.
voxel::Octree cut_bridges(const voxel::Octree& whole, const BridgeDecisions& bridges);
voxel::Expression cut_bridges(voxel::Expression symbol, const BridgeDecisions& bridges);
/// Adds to `shift_mm` how far operands were moved. Throws as brep::boolean().
brep::Solid cut_bridges(brep::Solid whole, const BridgeDecisions& bridges, const std::stop_token& stop,
                        double& shift_mm);
verify::Witness cut_bridges(verify::Witness whole, const BridgeDecisions& bridges);

/// The chosen parts, together with the parts that the decisions keep.
voxel::Octree with_kept_parts(const voxel::Octree& chosen, const voxel::Octree& whole,
                              const BridgeDecisions& bridges, voxel::Neighbours neighbours);
/// Whether the decisions keep a part, which is given by its triangles' indices. `triangles` is not read where
/// no decision keeps a part.
bool stays(const brep::Triangles& triangles, const std::vector<std::uint32_t>& faces,
           const BridgeDecisions& bridges);

/// The `count` largest parts of voxels. Of parts of the same size as the last selected one, those with the
/// lowest first voxel are selected, x fastest; where more than 64 such parts are needed, all of them stay.
/// Precondition: the object is not empty, `count` is positive.
voxel::Octree largest_parts(const voxel::Octree& whole, std::size_t count,
                            voxel::Neighbours neighbours = voxel::Neighbours::Faces);

/// The parts that stay, as a mesh.
struct KeptParts {
  brep::Mesh mesh;
  std::vector<std::uint32_t> faces;  ///< of the whole, ascending
  std::size_t kept = 0, of = 0;
};

/// The parts of a closed mesh that are among the `largest` largest and have at least a volume, each with its
/// cavities; and the parts that the decisions keep.
KeptParts kept_parts(const brep::Mesh& mesh, std::optional<int> largest, std::optional<double> at_least_mm3,
                     const BridgeDecisions& bridges = {});

/// The expression of the parts that were selected from an object's voxels. The samples around the parts
/// remain in it: they place the surface within a voxel, and a motion samples that surface.
voxel::Expression symbol_of_parts(const voxel::Expression& symbol, const voxel::Octree& object,
                                  const voxel::Octree& parts);

/// The expression of an object whose cavities were filled. The filling extends into the voxels around it, so
/// that a motion leaves no gap between the filling and the surface of the samples.
voxel::Expression symbol_of_filled(const voxel::Expression& symbol, const voxel::Octree& object,
                                   const voxel::Octree& filled);

}  // namespace octotomy::planner
