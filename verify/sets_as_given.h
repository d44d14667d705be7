// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "brep/boolean/boolean.h"
#include "verify/certificate.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// Both kernels' answers to a Boolean of two sets of voxels as they are, coplanar faces and touching edges
/// included, and their certificate.
struct SetsAnswer {
  voxel::Octree octree;
  /// In LPS millimetres, as corefined; none: the mesh kernel cannot represent it, the certificate says why.
  std::optional<brep::Solid> solid;
  std::vector<std::string> findings;  ///< of the corefinement
  Certificate certificate;
};

/// Combines the octrees, and corefines the sets' cuberilles (tier Exact). Where faces coincide corefinement
/// may move an operand by a few millionths of its extent; so the answer's corners are rounded to the lattice
/// they came from, and a corner that lies nowhere near it is an error. Then volumes must be one whole number
/// of voxels, and the mesh must hold the same voxels' centres before and after. FAIL if anything differs,
/// WARN without a mesh. Throws std::invalid_argument if the universes differ; voxel::Stopped. Cost: some
/// 10 us a face of the sets.
SetsAnswer certify_sets(const voxel::Octree& a, brep::Operation operation, const voxel::Octree& b,
                        const voxel::Progress& progress = {});

}  // namespace octotomy::verify
