// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/expression.h"
#include "voxel/solid/resampling.h"

namespace octotomy::voxel {

struct GreyResult {
  /// The sample, in the scan's unit, of voxels outside the expression. These voxels are not part of the
  /// result's scan.
  double background = -1024.0;
  /// The sample, in the scan's unit, of voxels that are filled only by objects without samples (octrees,
  /// masks, primitives). Default: the largest sample of 12-bit scanners.
  double filled = 3071.0;
  Resampling resampling;
};

/// The voxels of an expression with their samples, as a grey octree whose ranges are computed from the
/// result. A voxel's sample is that of the first window of the expression, in reading order, that contains
/// the voxel and is not under a complement or to the right of a minus. If there is none, it is the sample of
/// the first window whose complement contains the voxel, and otherwise `filled`. Of a union's operands only
/// those that contain the voxel supply samples: in `move(h & c, m) | (h - c)` a voxel of `h - c` alone keeps
/// the sample of `h` at rest. Samples of moved windows are interpolated once and rounded, halves upward. The
/// voxels are those of combine(). Throws std::invalid_argument if the windows' samples have different steps.
/// Parallel; same bits on any thread count. Cost: that of combine(), once for the expression and once for
/// each operand of a union that contains windows and is neither a window nor a union. Memory: these operands'
/// octrees, and the samples of the blocks that contain a voxel. Source: thesis 7.2 for grey operands.
GreyOctree combine_grey(const Universe& universe, const Expression& expression,
                        const GreyResult& options = {});

}  // namespace octotomy::voxel
