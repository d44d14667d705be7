// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/mesh/mesh.h"
#include "planner/operation/bridges.h"
#include "voxel/solid/expression.h"

// Choosing connected parts in each kernel, for every operation that does.
namespace octotomy::planner {

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

/// What an object's symbol becomes where parts were chosen from its voxels: the samples about the parts still
/// say where their surface lies within a voxel, so that a motion samples it there.
voxel::Expression symbol_of_parts(const voxel::Expression& symbol, const voxel::Octree& object,
                                  const voxel::Octree& parts);

/// The same where cavities were filled: the filling reaches into the voxels about it, so that a motion leaves
/// no gap between them and the surface that the samples show.
voxel::Expression symbol_of_filled(const voxel::Expression& symbol, const voxel::Octree& object,
                                   const voxel::Octree& filled);

}  // namespace octotomy::planner
