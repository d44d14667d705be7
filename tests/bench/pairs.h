// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <span>

#include "voxel/solid/expression.h"
#include "voxel/tree/octree.h"

namespace octotomy::bench {

/// Operands of a Boolean at a universe size. Both are octrees, built on first use and kept alive.
struct Pair {
  const char* name;
  const voxel::Octree& (*first)(int side);
  const voxel::Octree& (*second)(int side);
};
std::span<const Pair> pairs();

/// The motions that are measured: a translation by whole voxels, and a turn of 5 degrees with a translation.
voxel::Motion translation(int side);
voxel::Motion rotation();

}  // namespace octotomy::bench
