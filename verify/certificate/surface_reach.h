// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "brep/mesh/triangles.h"
#include "verify/certificate/certificate.h"
#include "verify/witness/reshaped_witness.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// The region in which judge_reach() compares surfaces, and how finely it samples them.
struct ReachOptions {
  voxel::Box world_mm;      ///< box at whose border the answer ends, unlike the expected surface
  double shift_mm = 0.0;    ///< how far earlier Booleans moved the operand; added to the reach
  double spacing_mm = 1.0;  ///< largest spacing of samples on a triangle; above 0
};

/// Adds two comparisons to the certificate: the largest distance of the answer's surface from the surface
/// where it must lie, and the reverse. Distances are measured at all vertices, and at points of sides and
/// triangles no farther apart than the spacing. A distance above reach_doubt times the reach is a FAIL.
/// Raises the detection limit to the volume of a layer of that thickness over the whole surface, because an
/// answer may be off by that thickness. FAIL if only one surface is empty, unless the expected one lies only
/// at the world's border. Throws voxel::Stopped. Parallel; same answer on any thread count. Cost: one search
/// of a grid for each sample; for missing or added parts some hundred longer searches.
void judge_reach(Certificate& certificate, const brep::Triangles& answer, const ReshapedSurface& expected,
                 const ReachOptions& options, const voxel::Progress& progress = {});

}  // namespace octotomy::verify
