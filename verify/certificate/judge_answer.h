// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "verify/certificate/certify_operation.h"
#include "voxel/tree/octree.h"

// Compares another program's answer to a Boolean with both kernels' answers: one certificate per kernel.
namespace octotomy::verify {

/// Both kernels' answers to one question.
struct KernelAnswers {
  voxel::Octree octree;
  std::optional<brep::Solid> solid;
  double shift_mm = 0.0;              ///< how far the Boolean that computed the solid moved operands
  std::vector<std::string> findings;  ///< of that Boolean
};

/// Judges a mesh in any state. A mesh that is no closed, oriented surface fails. The mesh is compared with
/// the octree at voxels' centres. It is compared with the solid by volume, and by the distances of the
/// corners and triangle centroids of each from the surface of the other. The tolerance is the rounding of a
/// file with 32-bit coordinates plus `shift_mm`. Throws as convert::voxelise(); voxel::Stopped.
std::vector<Certificate> judge_mesh(const KernelAnswers& kernels, const brep::Triangles& answer,
                                    const voxel::Progress& progress = {});

/// Judges a set of voxels. Throws std::invalid_argument unless the set has the universe of the kernels'
/// octree. The set is compared with the octree voxel by voxel, except where a voxel's centre lies so near the
/// solid's surface that rounding decides its side. The set is compared with the solid at voxels' centres.
std::vector<Certificate> judge_voxels(const KernelAnswers& kernels, const voxel::Octree& answer);

}  // namespace octotomy::verify
