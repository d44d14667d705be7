// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "voxel/solid/slice_mask.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Contour following on slices (thesis 2.3.2.2.1). The mesh kernel has a separate implementation.
namespace octotomy::voxel {

/// A closed line in a slice, in voxel indices x, y; the closing edge is implied. With x to the right and y
/// upwards, the object is on the line's left. Outer boundaries therefore have a positive area, holes a
/// negative one.
using SliceContour = std::vector<glm::dvec2>;

/// The boundaries of the samples of slice `k` that are at least the threshold. A contour has one point,
/// linearly interpolated, for every pair of neighbouring samples on different sides of the threshold. Samples
/// that touch only at a corner are not connected (the thesis's 1-connectivity). Beyond the slice everything
/// counts as outside: along the border, points lie half a voxel beyond the border samples' centres, on the
/// voxels' edges. Contours are sorted by their first points, x fastest. Throws std::invalid_argument if there
/// is no slice k or the threshold is not finite. Cost: one pass over the slice, one bit per sample.
std::vector<SliceContour> slice_contours(const Scene& scene, int k, double threshold);

/// The contour with fewer points by Douglas and Peucker (Canadian Cartographer 10, 1973): no dropped point is
/// farther than `most` voxels from the edge that replaces it. A contour of fewer than four points is returned
/// unchanged.
SliceContour thinned(const SliceContour& contour, double most);

struct ContourOptions {
  double threshold = 0.0;  ///< in sample units
  double thin = 0.05;      ///< as thinned(), in voxels
  double least_mm2 = 0.0;  ///< contours of at most this area are left out
  Progress progress{};
};
/// The contours of every slice as regions that can be edited (thesis 6.2.1.3). Throws std::invalid_argument
/// if the slices lean by more than a tenth of a degree from a plane across one of the patient's axes; also
/// throws as slice_contours() does; Error (Geometry) if there is no contour; Stopped.
SliceMask contour_regions(const Scene& scene, const ContourOptions& options);

/// The name of the view that contour_regions() draws in: "inferior", "anterior" or "right".
std::string contour_view(const Lattice& lattice);

}  // namespace octotomy::voxel
