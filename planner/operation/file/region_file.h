// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "voxel/solid/region_mask.h"
#include "voxel/solid/slice_mask.h"
#include "voxel/space/scene.h"

// Reads regions that were drawn elsewhere, from JSON files and DICOM structure sets. Points are [u, v] in the
// view's millimetres.
namespace octotomy::planner {

/// Reads {"polygons_mm": [[[u, v], ...], ...]}, or that list of polygons alone. Throws std::runtime_error
/// with the file, the place in it and the expected content.
voxel::Region read_region(const voxel::View& view, const std::filesystem::path& path);

/// {"view": "inferior", "between": "shape_based" or "nearest", "slices": [{"position_mm": p . look,
/// "polygons_mm": [...]}, ...]}; "between" may be left out. Slices are sorted by position. Throws as
/// read_region(), and for masks that check(SliceMask) refuses.
///
/// From a DICOM structure set: the region with this name, or with this ROI number if no region or several
/// have the name. Its closed contours are polygons of its planes, holes by the even-odd rule. The distance of
/// planes is that of the set's nearest ones. At a plane without a contour the region is empty. The region
/// extends half a distance beyond its first and last plane. A region continues between its planes if the file
/// declares it as interpolated, by the type INTERPOLATED_PLANAR or by slabs as thick as the distance of its
/// planes. Throws std::runtime_error if the set has no region or several regions of the name; if no name is
/// stated and the set has several regions; or if the region's contours cannot be read or do not lie in
/// parallel planes. Also throws if all planes of the set lie within 0.02 mm, because then their distance is
/// unknown.
///
/// A voxel whose centre lies on a contour, within a millionth of a millimetre, is inside if the region
/// continues towards larger u, v or position. So it counts once among regions that share the contour.
///
/// Contours of a plane that are equal within 0.01 mm count once. Points up to 0.1 mm off a plane belong to it if
/// planes are ten times as far apart.
voxel::SliceMask read_slices(const std::filesystem::path& path, const std::string& structure = {});

/// Reads as read_slices() above. Adds to `findings` one finding on contours that occur twice, and one on
/// contours that cross themselves or another contour of their plane, so that the even-odd rule leaves a part
/// out. A finding states their number, planes and positions. For structure sets, also adds one finding each
/// on gaps between planes, on contours without area, and on points off their plane.
voxel::SliceMask read_slices(const std::filesystem::path& path, const std::string& structure,
                             std::vector<std::string>& findings);

struct SlicesOptions {
  std::string structure = {};  ///< of a structure set
  /// Only for a structure set: gaps up to this width between neighbouring planes of the region are
  /// interpolated instead of left empty. None: only gaps that the file declares as interpolated.
  std::optional<double> bridge_mm = std::nullopt;
};
struct DrawnSlices {
  voxel::SliceMask mask;
  std::optional<voxel::Identity> identity = std::nullopt;  ///< of a structure set
  std::vector<std::string> findings = {};
};
/// Reads slices, with all that the file states about their patient and frame of reference.
DrawnSlices read_slices(const std::filesystem::path& path, const SlicesOptions& options);

}  // namespace octotomy::planner
