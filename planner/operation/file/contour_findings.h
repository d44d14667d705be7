// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "voxel/solid/region_mask.h"
#include "voxel/solid/slice_mask.h"
#include "voxel/space/lattice.h"

// Findings on contours on slices. Each sentence begins with `where`.
namespace octotomy::planner {

/// Rounding to a decimal string moves a plane by at most this distance.
constexpr double off_plane_mm() {
  return 0.01;
}

/// Removes repeated contours of a plane except one of each, because the even-odd rule would delete them in
/// pairs. Adds a finding on these, and one on contours that cross themselves or another contour of their
/// plane.
void add_contour_findings(voxel::SliceMask& mask, const std::string& where,
                          std::vector<std::string>& findings);

/// One finding on polygons of a region that repeat another polygon, and one on polygons that cross themselves
/// or another polygon. In both cases the region of the even-odd rule differs from the union of the filled
/// polygons.
std::vector<std::string> findings_of(const voxel::Region& region);

/// A finding on contours that reach beyond a scan's samples: the number of their planes, the farthest
/// distance and its place, and the share of the volume beyond. None if all contours lie within the scan.
/// `where` begins the finding.
std::optional<std::string> beyond_scan(const voxel::SliceMask& mask, const voxel::Lattice& scan,
                                       const std::string& where);

/// A finding on slices of a scan without contours: neighbouring planes with contours that skip two or more of
/// the slices. None if there are no such planes, or if the planes' normal is not one of the scan's axes.
std::optional<std::string> slices_without_contours(const voxel::SliceMask& mask, const voxel::Lattice& scan,
                                                   const std::string& where);

/// A finding that begins with FAIL and states the part of the contours' volume that lies beyond the octree's
/// cube and is left out. None if the whole volume lies within.
std::optional<std::string> cut_at_cube(const voxel::SliceMask& mask, const voxel::Universe& universe,
                                       const std::string& where);

}  // namespace octotomy::planner
