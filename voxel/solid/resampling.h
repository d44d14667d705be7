// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/interpolate.h"

namespace octotomy::voxel {

/// How operands that do not lie on the target's lattice are carried to it: those under a motion, and those of
/// another universe.
struct Resampling {
  /// Which voxels an octree becomes: those whose centre it holds (D3), or those it fills at least to the half
  /// (D4), counted on a grid of 5 x 5 x 5 points a voxel.
  enum class Voxels { Centre, Half };
  Voxels voxels = Voxels::Centre;
  /// How a grey octree's samples are read between them, before its window is taken.
  Interpolation samples = Interpolation::Linear;
};

}  // namespace octotomy::voxel
