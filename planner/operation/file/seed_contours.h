// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "planner/operation/table/sample_window.h"
#include "voxel/solid/slice_mask.h"
#include "voxel/space/scene.h"

// Contours whose thresholds come from seed pixels (thesis 2.3.2.2.1).
namespace octotomy::planner {

/// The contour that was found for a seed.
struct SeedContour {
  glm::dvec3 seed_mm{0.0};   ///< as given, LPS
  double threshold = 0.0;    ///< the sample nearest to it
  double position_mm = 0.0;  ///< of its slice, in the view of the contours
  double away_mm = 0.0;      ///< of the contour from that sample's middle, within the slice
  bool is_far = false;       ///< farther than the diagonal of a pixel: the seed lies on no edge
};

struct SeedContours {
  voxel::SliceMask mask;
  std::vector<SeedContour> seeds;  ///< in the order of the seeds
};

/// For each seed, the nearest contour of its slice at the seed's own sample as threshold; a contour that
/// several seeds lead to appears once. The mask has the seeds' slices and, where the scan continues, an empty
/// slice at either end. Throws std::runtime_error naming the seed if it lies outside of the scan or on
/// padding, or if its slice has no contour at its threshold; if two contours of a slice cross, which is
/// possible where seeds there have different samples; and as slice_contours().
SeedContours contours_at_seeds(const voxel::Scene& scene, const std::vector<glm::dvec3>& seeds_mm);

/// The samples that belong to the region around a seed: those of a window, or those no farther from the seed's own
/// sample than the tolerance. Exactly one of the two is set.
struct RegionSamples {
  std::optional<SampleWindow> window;
  std::optional<double> tolerance;
};

/// For each seed, the contour around the connected region of the slice that contains the seed, and the
/// contours of the region's holes; a region with several seeds appears once. `threshold` is the lower bound,
/// `away_mm` the distance of the seed from the region's contours. The mask and the exceptions are those of
/// contours_at_seeds(); a seed outside the window is refused with its sample.
SeedContours contours_around_seeds(const voxel::Scene& scene, const std::vector<glm::dvec3>& seeds_mm,
                                   const RegionSamples& samples);

}  // namespace octotomy::planner
