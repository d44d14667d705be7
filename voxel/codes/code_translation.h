// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/codes/cuberille_faces.h"
#include "voxel/codes/marginal_index.h"
#include "voxel/codes/run_length.h"
#include "voxel/codes/segment_index.h"

namespace octotomy::voxel {

// Translate an object by whole voxels within its code, without an octree (thesis 7.4.1, 7.4.2). Voxels that
// leave the universe are lost. Precondition: the code passes the checks of octree_of().

/// Adds the step to every face. Throws std::invalid_argument if a face leaves the universe, because the list
/// would lack the faces at which the universe cuts the object off.
CuberilleFaces translated(const CuberilleFaces& faces, const glm::ivec3& by);
/// Moves the slices' and rows' pointers along z and y, and shifts the rows' bits along x.
MarginalIndex translated(const MarginalIndex& index, const glm::ivec3& by);
/// Moves the slices' and rows' pointers, and adds the step along x to the segments' ends.
SegmentIndex translated(const SegmentIndex& index, const glm::ivec3& by);
/// Codes the runs again row by row, because a run may continue across the end of a row.
RunLength translated(const RunLength& code, const glm::ivec3& by);

}  // namespace octotomy::voxel
