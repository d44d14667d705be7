// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

struct ScaleSpaceOptions {
  /// Standard deviation of the coarsest blur; objects at about this distance or less become one.
  double sigma_mm = 4.0;
  double low = 0.0;  ///< the window, in sample units, both bounds included: samples outside have no label
  double high = 0.0;
  bool is_dark = false;  ///< follows minima, for objects that are darker than their surroundings
  Progress progress{};
};

/// The regions of a scan that belong to one maximum of its coarsest blur, as a label map: 1 is the largest.
struct ScaleSpace {
  Scene labels;
  /// Widths of the stack's blurs, from the coarsest to the finest; 0 is the scan itself.
  std::vector<double> sigmas_mm;
  std::vector<std::size_t> maxima;  ///< number of maxima at each of these widths
  /// Number of samples of each label: of label 1, which is the largest, then of label 2, ...
  std::vector<std::uint64_t> samples;
};

/// Follows the maxima of a scan through scale space (thesis 2.3.4; Pizer et al., Information Processing in
/// Medical Imaging, 1986). The stack holds blurs by Gaussians whose widths fall by the square root of two from
/// the coarsest to about a voxel, then the scan. At each level every sample ascends to a maximum, step by
/// step to the highest of the 26 neighbours. Each maximum of the coarsest blur is a label; from there to the
/// scan, each maximum of a finer level, with all samples that ascend to it, gets the label that the coarser
/// level has at the maximum. So touching objects are separated where brightness falls between them, and noise
/// makes no objects, because the coarsest blur removes it. A flat top of the coarsest blur is one maximum; on
/// a finer level each of its samples is a maximum, so that the flat top of a saturated object is not joined
/// across a neck. Throws InvalidInput for label maps, a window without numbers, and as gaussian() does; Error
/// (Geometry) if no sample or more than 32767 regions are in the window; Stopped. Same bits on any thread
/// count. Memory: 16 bytes per sample.
ScaleSpace scale_space(const Scene& scene, const ScaleSpaceOptions& options);

}  // namespace octotomy::voxel
