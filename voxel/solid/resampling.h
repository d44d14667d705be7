// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/interpolate.h"

namespace octotomy::voxel {

/// How operands are resampled that do not lie on the target's lattice: operands under a motion, and operands
/// of another universe.
struct Resampling {
  /// Which voxels of the target an octree fills: voxels whose centre is in the octree (D3), or voxels at
  /// least half of which is in the octree (D4), counted on a grid of 5 x 5 x 5 points a voxel.
  enum class Voxels { Centre, Half };
  Voxels voxels = Voxels::Centre;
  /// Interpolation between a grey octree's samples, before they are compared with its window.
  Interpolation samples = Interpolation::Linear;
};

}  // namespace octotomy::voxel
