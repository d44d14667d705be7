// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "voxel/solid/expression.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

struct ExpressionScanOptions {
  /// The sample where the expression contains nothing, in the scan's unit. None: the frame's padding. If the
  /// frame has no padding, the value is below all samples, so that no window contains it, and becomes the
  /// result's padding.
  std::optional<double> hole;
  /// The sample, in the scan's unit, of voxels that are filled only by objects without samples. Default: 3071
  /// for samples in Hounsfield units, otherwise the frame's largest sample.
  std::optional<double> filled;
  Progress progress;
};

struct ExpressionScan {
  Scene scene;
  std::uint64_t hole_samples = 0;    ///< number of samples outside the expression
  std::uint64_t filled_samples = 0;  ///< number of samples in objects without samples only
  /// Holes, and samples that differ from the frame's sample at this place.
  std::uint64_t changed_samples = 0;
  double hole = 0.0, filled = 0.0;  ///< as used
};

/// Computes the scan that a scanner would make of an expression: samples on the frame's lattice, each from
/// the operand that owns the voxel by the rules of GreyOwners. A sample at rest keeps its bits; one of a
/// moved operand is interpolated once, trilinearly between that operand's own samples. The frame's padding
/// remains outside the expression. Lattice, type and meaning of the samples and the patient's identity are
/// the frame's. `of_frame` is a grey octree that stores the frame (GreyOctree::with_scan()). Windows of the
/// expression supply samples if they belong to this octree or to others whose samples have the same steps.
/// Windows in other steps, such as those of offset(), only limit the voxels.
///
/// Throws Error (Input) if the frame has more than 1,024 samples a side or extends beyond the octree's
/// universe, if the samples cannot have the value of `hole` or `filled`, or if no value is left for holes;
/// Stopped. Parallel; same bits on any thread count. Cost and memory: those of combine() and GreyOwners on
/// the frame's lattice, and a copy of the frame's samples. Source: thesis, chapter 7: grey octrees of a
/// plan's objects.
ExpressionScan expression_scan(const Scene& frame, const GreyOctree& of_frame, const Expression& expression,
                               const ExpressionScanOptions& options = {});

}  // namespace octotomy::voxel
