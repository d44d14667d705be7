// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "voxel/scan/dicom_source.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

struct DicomSegOptions {
  std::string label = "Object";  ///< the file's name, and that of a lone object's segment: 1 to 64
  std::string series_description = "Octotomy";  ///< 1 to 64 characters
  /// The series that the object was made from. The segmentation takes over its patient, study and frame of
  /// reference, and each frame refers to the images behind it. None: a phantom in a study of its own.
  std::optional<DicomSource> source = std::nullopt;
  Progress progress = {};
};

/// An object of a segmentation; several may share voxels.
struct DicomSegment {
  std::string label;  ///< 1 to 64 characters
  Octree object;      ///< not empty
};

/// Writes an object as a DICOM segmentation (PS3.3, A.51): one binary segment; one frame for each plane of
/// voxels along the universe's third axis that holds a voxel, cropped to the object. The voxels are the
/// octree's own, not resampled to the source's lattice. Unique identifiers come from the content: the same
/// object and options give the same bytes. Written beside and renamed into place.
/// Throws std::invalid_argument if the object is empty, the universe's axes are not perpendicular or a text
/// is too long; Error, Geometry, if the frames take more than DICOM's 4 GB; Error, Resource or Input, with
/// path and reason; Stopped. Cost: the planes' pixels; memory: two bits a pixel.
void write_dicom_seg(const Octree& object, const std::filesystem::path& path,
                     const DicomSegOptions& options = {});

/// The same for several named objects of one universe: segment i + 1 is segments[i], each with frames of its
/// own, cropped to the rectangle around all. On universe_on() of a scan's lattice each frame lies on a slice
/// of the scan. Throws also std::invalid_argument for no segment, more than 65535 and different universes.
void write_dicom_seg(std::span<const DicomSegment> segments, const std::filesystem::path& path,
                     const DicomSegOptions& options = {});

}  // namespace octotomy::voxel
