// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "verify/certificate/certificate.h"
#include "verify/witness/reshaped_witness.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// The allowed distance between an answer and the surface where it must lie, in addition to the surface's
/// own reach.
struct ReachOptions {
  voxel::Box world_mm;      ///< the answer ends there and the surface does not
  double shift_mm = 0.0;    ///< how far Booleans on the way moved the operand
  double spacing_mm = 1.0;  ///< of samples on a triangle, above 0
};

/// Adds to the certificate of an answer the largest distance of its surface from the surface where it must
/// lie, and the other way round: at all vertices, and at points of sides and triangles no farther apart
/// than the spacing. Each distance fails beyond reach_doubt times the reach. Raises the detection limit to
/// the volume of a layer of that thickness over the whole surface, because an answer may be off by that
/// thickness. FAIL if only one of the two is empty. Throws voxel::Stopped. Parallel; same answer on any
/// thread count. Cost: one search of a grid for each sample; for parts that are missing or added some
/// hundred longer ones.
void judge_reach(Certificate& certificate, const brep::Triangles& answer, const ReshapedSurface& expected,
                 const ReachOptions& options, const voxel::Progress& progress = {});

}  // namespace octotomy::verify
