// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "voxel/solid/region_mask.h"
#include "voxel/solid/slice_mask.h"
#include "voxel/space/lattice.h"

// Findings on contours on slices, in sentences that begin with `where`.
namespace octotomy::planner {

/// The largest error of a plane's position that rounding to a decimal string causes, as a share of the least
/// distance of planes.
constexpr double off_plane_mm() {
  return 0.01;
}

/// Removes contours that repeat another one of their plane, because the even-odd rule would delete both. Adds a
/// finding on these, and one on contours that cross themselves or another one of their plane.
void add_contour_findings(voxel::SliceMask& mask, const std::string& where,
                          std::vector<std::string>& findings);

/// One finding on the polygons of a region that repeat another, and one on those that cross themselves or
/// another. There the even-odd rule yields another region than filling each polygon.
std::vector<std::string> findings_of(const voxel::Region& region);

/// A finding on contours that reach beyond a scan's samples: the number of planes, the distance, the place
/// and the share of the volume. None if all contours lie within the scan. `where` begins the finding.
std::optional<std::string> beyond_scan(const voxel::SliceMask& mask, const voxel::Lattice& scan,
                                       const std::string& where);

/// A line on contours that leave out slices of a scan: neighbouring planes with contours that are joined over
/// two or more of its slices along the planes' normal. None where the planes' normal is none of the scan's
/// axes.
std::optional<std::string> slices_without_contours(const voxel::SliceMask& mask, const voxel::Lattice& scan,
                                                   const std::string& where);

/// A FAIL that states the part of the contours' volume that lies beyond the octree's cube and is left out. None where
/// all lies within.
std::optional<std::string> cut_at_cube(const voxel::SliceMask& mask, const voxel::Universe& universe,
                                       const std::string& where);

}  // namespace octotomy::planner
