// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "voxel/progress.h"
#include "voxel/scene.h"
#include "voxel/slice_mask.h"

// Contour following on slices (thesis 2.3.2.2.1), for the voxel kernel's own use.
namespace octotomy::voxel {

/// A closed line in a slice, in voxel indices x, y; the closing edge is implied. What it bounds is on its
/// left where x runs to the right and y upwards: outer boundaries have a positive area, holes a negative one.
using SliceContour = std::vector<glm::dvec2>;

/// The boundaries of the samples of slice `k` that are at least the threshold, one point for every pair of
/// neighbouring samples that straddles it, linearly interpolated between them. Samples that touch by a corner
/// only are apart (the thesis's 1-connectivity). Beyond the slice everything is outside: there points lie
/// half a voxel beyond the border samples' centres, on the voxels' edges. In the order of each contour's
/// first point, x fastest. Throws std::invalid_argument where there is no slice k, or the threshold is not
/// finite. Cost: one pass over the slice, a bit a sample.
std::vector<SliceContour> slice_contours(const Scene& scene, int k, double threshold);

/// The contour around a sample of the slice, which is its threshold: that which is met going from it against
/// y. Throws std::invalid_argument where the seed is not in the scene.
SliceContour contour_at(const Scene& scene, const glm::ivec3& seed);

/// Twice the signed area is the sum of cross products; this is the area, in square voxels.
double area(const SliceContour& contour);

/// The contour with fewest points found by Douglas and Peucker (Canadian Cartographer 10, 1973), so that no
/// point left out is farther than `most` voxels from the edge in its place. Ends as it is where fewer than
/// four points are.
SliceContour thinned(const SliceContour& contour, double most);

struct ContourOptions {
  double threshold = 0.0;  ///< in sample units
  double thin = 0.05;      ///< as thinned(), in voxels
  double least_mm2 = 0.0;  ///< contours of less area are left out
  Progress progress{};
};
/// The contours of every slice as regions that can be edited (thesis 6.2.1.3). Slices must lie across one of
/// the patient's axes: throws std::invalid_argument where they lean by more than a tenth of a degree, and as
/// slice_contours(); std::runtime_error where there is no contour at all.
SliceMask contour_regions(const Scene& scene, const ContourOptions& options);

/// The name of the view that contour_regions() draws in: "inferior", "anterior" or "right".
std::string contour_view(const Lattice& lattice);

}  // namespace octotomy::voxel
