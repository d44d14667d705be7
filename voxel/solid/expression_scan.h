// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "voxel/solid/expression.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

struct ExpressionScanOptions {
  /// The sample where the expression contains nothing, in the scan's unit. None: the frame's padding. If
  /// the frame has no padding, a value below all its samples, which then becomes the result's padding,
  /// because no window contains it.
  std::optional<double> hole;
  /// Sample of voxels that only objects without samples fill. Default: 3071 for samples in Hounsfield units,
  /// otherwise the frame's largest sample.
  std::optional<double> filled;
  Progress progress;
};

struct ExpressionScan {
  Scene scene;
  std::uint64_t hole_samples = 0;     ///< where the expression contains nothing
  std::uint64_t filled_samples = 0;   ///< where only objects without samples are
  std::uint64_t changed_samples = 0;  ///< holes, and samples that differ from the frame's sample at this
                                      ///< place
  double hole = 0.0, filled = 0.0;    ///< as used
};

/// The scan that a scanner would make of an expression: samples on the frame's lattice, each from the
/// operand that owns its place, as GreyOwners decides. A sample at rest keeps its bits; one of a moved
/// operand is interpolated once, trilinearly between that operand's own samples. Padding of the frame stays
/// where the expression contains nothing. Lattice, type and meaning of the samples and the patient's
/// identity are the frame's. `of_frame` is a grey octree that keeps the frame (GreyOctree::with_scan());
/// the expression's windows belong to this octree or to others with samples in the same steps; windows in
/// other steps, such as those of offset(), limit the voxels but give no samples.
///
/// Throws Error (Input) if the frame has more than 1,024 samples a side or reaches out of the octree's
/// universe, if the samples cannot have the value of `hole` or `filled`, or if no value is left for holes;
/// Stopped. Parallel; same bits on any thread count. Cost and memory: those of combine() and GreyOwners on
/// the frame's lattice, and a copy of the frame's samples. Source: thesis, chapter 7: grey octrees of a
/// plan's objects.
ExpressionScan expression_scan(const Scene& frame, const GreyOctree& of_frame, const Expression& expression,
                               const ExpressionScanOptions& options = {});

}  // namespace octotomy::voxel
