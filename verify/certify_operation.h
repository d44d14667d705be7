// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/boolean.h"
#include "verify/certificate.h"

namespace octotomy::verify {

struct OperationAnswers {
  std::optional<voxel::Octree> octree;
  brep::Mesh mesh;
  Certificate certificate;
};

struct MeshOperationOptions {
  std::optional<double> voxel_mm;  ///< edge; none: a 128th of both operands' largest extent
};
/// A Boolean of two solids in both kernels: by corefinement, and by voxelising each (D3) and combining the
/// octrees; tier Bounded. Both have the very same surfaces, so that no voxel's centre may be inside of one
/// answer and outside of the other, but where it is as near to the surface as rounding, or the shift that
/// corefinement told, can decide. Volumes are compared loosely, by what sampling at centres can be off.
/// Throws as brep::boolean() and convert::voxelise(), std::length_error where the voxels are too small for a
/// universe.
OperationAnswers certify_operation(const brep::Mesh& a, brep::Operation operation, const brep::Mesh& b,
                                   const MeshOperationOptions& options = {});

}  // namespace octotomy::verify
