// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "voxel/solid/region_mask.h"
#include "voxel/solid/slice_mask.h"
#include "voxel/space/scene.h"

// Regions drawn elsewhere, as JSON files and structure sets. Points are [u, v] in the view's millimetres.
namespace octotomy::planner {

/// Reads {"polygons_mm": [[[u, v], ...], ...]}, or that list alone. Throws std::runtime_error with the
/// file, the place and the expected content.
voxel::Region read_region(const voxel::View& view, const std::filesystem::path& path);

/// {"view": "inferior", "between": "shape_based" or "nearest", "slices": [{"position_mm": p . look,
/// "polygons_mm": [...]}, ...]}; "between" may be left out. Slices are put in order. Throws as read_region(),
/// and for masks that check(SliceMask) refuses.
///
/// From a DICOM structure set: the region with this name, or with this ROI number if no region or several
/// have the name. Its closed contours are polygons of its planes, holes by the even-odd rule. Planes are as
/// far apart as the set's nearest ones. The region is empty at a plane without a contour; the first and the
/// last plane stand for half a distance beyond them. A region that the file declares as interpolated, by the
/// type INTERPOLATED_PLANAR or by slabs as thick as its planes are apart, continues between its planes.
/// Throws std::runtime_error if no region of the set has the name or several have it, or if no name is given
/// and there are several regions; if the region's contours cannot be read, lie in no parallel planes, or lie
/// all in one plane or in planes within 0.02 mm, which determine no distance.
///
/// A voxel whose centre lies on a contour, within a millionth of a millimetre, is inside if the region
/// continues towards larger u, v or position. So it counts once among regions that share the contour.
///
/// Contours of a plane that are equal within 0.01 mm count once. Points up to 0.1 mm off a plane belong to it if
/// planes are ten times as far apart.
voxel::SliceMask read_slices(const std::filesystem::path& path, const std::string& structure = {});

/// As read_slices() above. Adds to `findings` one finding on contours that occur twice, and one on contours
/// that cross themselves or another contour of their plane, so that the even-odd rule leaves a part out:
/// their number, planes and places. For structure sets also one line each on planes without a contour between
/// others, on contours that enclose nothing, and on points off their plane.
voxel::SliceMask read_slices(const std::filesystem::path& path, const std::string& structure,
                             std::vector<std::string>& findings);

struct SlicesOptions {
  std::string structure = {};  ///< of a structure set
  /// For a structure set: neighbouring planes of the region up to this distance apart are interpolated, so
  /// that the space between them is not empty. None: as the file states.
  std::optional<double> bridge_mm = std::nullopt;
};
struct DrawnSlices {
  voxel::SliceMask mask;
  std::optional<voxel::Identity> identity = std::nullopt;  ///< of a structure set
  std::vector<std::string> findings = {};
};
/// Reads slices with all that the file states about them.
DrawnSlices read_slices(const std::filesystem::path& path, const SlicesOptions& options);

}  // namespace octotomy::planner
