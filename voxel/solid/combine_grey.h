// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "voxel/solid/expression.h"
#include "voxel/solid/resampling.h"

namespace octotomy::voxel {

struct GreyResult {
  /// Sample of the voxels that the expression does not hold: they are beyond the result's scan.
  std::int16_t background = -1024;
  /// Sample of the voxels that only objects without samples fill: octrees, masks, primitives. Default: the
  /// brightest of 12-bit scanners.
  std::int16_t filled = 3071;
  Resampling resampling;
};

/// The voxels of an expression with their samples, as a grey octree whose ranges are its own. A voxel has the
/// sample of the first window of the expression, in reading order, that holds it and is not under a
/// complement or to the right of a minus. Failing that, the sample of a window whose complement holds it;
/// else `filled`. Samples of moved windows are interpolated once, halves upward, and the voxels are those of
/// combine(). Parallel; same bits on any thread count. Memory: the samples of the blocks that hold a voxel.
/// Source: thesis 7.2 for grey operands.
GreyOctree combine_grey(const Universe& universe, const Expression& expression,
                        const GreyResult& options = {});

}  // namespace octotomy::voxel
