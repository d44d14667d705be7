// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "verify/certificate/certify_operation.h"
#include "voxel/tree/octree.h"

// Anybody's answer to a Boolean, held against both kernels' answers, one certificate for each kernel.
namespace octotomy::verify {

/// Both kernels' answers to one question.
struct KernelAnswers {
  voxel::Octree octree;
  std::optional<brep::Solid> solid;
  double shift_mm = 0.0;              ///< how far the solid's making moved operands
  std::vector<std::string> findings;  ///< of the solid's making
};

/// A mesh in any state. It fails where it is no closed, oriented surface. Against the octree at voxels'
/// centres; against the solid by volume, and by the distances of either's corners and triangles' middles from
/// the other's surface. Allowed is what a file of 32-bit coordinates rounds, and the shift of an operand that
/// the solid's making reported. Throws as convert::voxelise(); voxel::Stopped.
std::vector<Certificate> judge_mesh(const KernelAnswers& kernels, const brep::Triangles& answer,
                                    const voxel::Progress& progress = {});

/// A set of voxels of the octree's own universe (else std::invalid_argument). Against the octree voxel by
/// voxel but for those whose centre rounding decides; against the solid at voxels' centres.
std::vector<Certificate> judge_voxels(const KernelAnswers& kernels, const voxel::Octree& answer);

}  // namespace octotomy::verify
