// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "voxel/scan/dicom_source.h"
#include "voxel/scan/write_dicom_seg.h"

namespace octotomy::voxel {

/// The planes on which contours are drawn.
enum class ContourPlanes {
  Images,  ///< the planes of the source's images; without a source, the planes of the voxels
  Voxels,  ///< the planes of the voxels
};

struct RtstructOptions {
  std::string label = "Objects";                ///< of the structure set: 1 to 64 characters
  std::string series_description = "Octotomy";  ///< 1 to 64 characters
  ContourPlanes planes = ContourPlanes::Images;
  /// The series from which the objects were made, as for write_dicom_seg(); each contour refers to the images
  /// of its plane.
  std::optional<DicomSource> source = std::nullopt;
  Progress progress = {};
};

/// Counts of the outlines drawn for an object, and how far the outlines are from the object's voxels.
struct ContouredObject {
  std::string name;
  std::size_t planes = 0, contours = 0, holes = 0, points = 0;
  /// Planes of voxels on which no contour is drawn, because no image lies there.
  std::size_t planes_left_out = 0;
  /// The largest distance between a drawn plane and the plane of voxels that it shows.
  double farthest_mm = 0.0;
};

/// Writes objects of one universe as a DICOM structure set (PS3.3, A.19), one region of interest for each.
/// Its contours on a plane are the boundaries of the object's voxels there, along the voxels' edges. A region
/// with a hole has the type CLOSEDPLANAR_XOR, which combines the contours of each plane by exclusive or;
/// other regions have the type CLOSED_PLANAR. A voxel's centre is inside a region exactly if the voxel is in
/// the object, and the contours enclose the same area as the voxels. Images between the voxels' planes show
/// the nearest plane. Identifiers are computed from the content; patient and study are those of the source,
/// as in write_dicom_seg(). Coded with implicit VR, because contours may be longer than explicit VR allows.
/// Written to a temporary file and renamed into place. Throws std::invalid_argument if there is no object, an
/// object is empty, universes differ, a text is too long, or planes of voxels are not parallel to the images;
/// Error (Geometry) if an object lies on none of the images; Error (Input or Resource) with path and reason;
/// Stopped. Cost: one pass over the pixels of all planes. Memory: the file's size.
std::vector<ContouredObject> write_rtstruct(std::span<const DicomSegment> objects,
                                            const std::filesystem::path& path,
                                            const RtstructOptions& options = {});

}  // namespace octotomy::voxel
