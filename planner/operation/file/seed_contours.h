// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "planner/operation/table/sample_window.h"
#include "voxel/solid/slice_mask.h"
#include "voxel/space/scene.h"

// Contours with thresholds from the samples at seeds (thesis 2.3.2.2.1).
namespace octotomy::planner {

/// A seed and the contour that was found for it.
struct SeedContour {
  glm::dvec3 seed_mm{0.0};   ///< as given, LPS
  double threshold = 0.0;    ///< threshold of the contour, in sample units
  double position_mm = 0.0;  ///< position of its slice in the view of the contours
  double away_mm = 0.0;      ///< distance of the contour from the centre of the seed's sample, within the
                             ///< slice
  bool is_far = false;       ///< the distance exceeds a pixel's diagonal, so the seed lies on no edge
};

struct SeedContours {
  voxel::SliceMask mask;
  std::vector<SeedContour> seeds;  ///< in the order of the seeds
};

/// Finds for each seed the nearest contour in its slice whose threshold is the sample at the seed. If several
/// seeds have the same contour, the mask contains it once. The mask has the seeds' slices and, where the scan
/// continues, an empty slice at either end. Throws std::runtime_error that names the seed if it lies outside
/// of the scan or on padding, or if its slice has no contour at the threshold. Also throws if two contours of
/// a slice cross, which can happen if their seeds have different samples, and as slice_contours().
SeedContours contours_at_seeds(const voxel::Scene& scene, const std::vector<glm::dvec3>& seeds_mm);

/// The samples that belong to the region around a seed: those in the window, or those that differ from the
/// seed's sample by at most the tolerance. Exactly one of the two must be set.
struct RegionSamples {
  std::optional<SampleWindow> window;
  std::optional<double> tolerance;
};

/// Finds for each seed the connected region of its slice that contains the seed: its outline and the contours
/// of its holes. A region with several seeds appears once. `threshold` is the lower bound, `away_mm` the
/// distance of the seed from these contours. Mask and exceptions are as for contours_at_seeds(); also throws
/// if a seed's sample lies outside of the window, stating the sample.
SeedContours contours_around_seeds(const voxel::Scene& scene, const std::vector<glm::dvec3>& seeds_mm,
                                   const RegionSamples& samples);

}  // namespace octotomy::planner
