// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "brep/boolean/boolean.h"
#include "verify/certificate/certificate.h"
#include "voxel/space/progress.h"

namespace octotomy::verify {

struct OperationAnswers {
  std::optional<voxel::Octree> octree;
  brep::Solid solid;
  double shift_mm = 0.0;              ///< how far the corefinement moved an operand
  std::vector<std::string> findings;  ///< of the corefinement
  Certificate certificate;
};

struct MeshOperationOptions {
  std::optional<double> voxel_mm;  ///< edge of a voxel; none: 1/128 of the operands' largest extent
  /// universe of the comparison; none: cubic voxels of edge voxel_mm around both operands
  std::optional<voxel::Universe> universe = {};
  voxel::Progress progress{};
};
/// Computes a Boolean of two solids in both kernels (tier Bounded): by corefinement, and by digitising each
/// operand at voxel centres (D3) and combining the octrees. Both kernels start from the same surfaces, so no
/// voxel's centre may be inside one answer and outside the other. Exempt are centres that lie nearer to the
/// surface than the rounding plus the shift that corefinement reported. The tolerance of the volumes is the
/// error of sampling at centres. Throws as brep::boolean() and convert::voxelise(); std::length_error if the
/// voxels are too small for a universe; voxel::Stopped.
OperationAnswers certify_operation(const brep::Solid& a, brep::Operation operation, const brep::Solid& b,
                                   const MeshOperationOptions& options = {});

/// Returns the operation as an expression, for example "a | b".
std::string text_of(brep::Operation operation);

/// Compares an octree with a solid that has the same surfaces, at voxels' centres (tier Bounded). `shift_mm`
/// and `findings` are those of the Boolean that computed the solid.
Certificate certify_at_centres(const voxel::Octree& octree, const brep::Solid& solid, double shift_mm,
                               const std::vector<std::string>& findings);

}  // namespace octotomy::verify
