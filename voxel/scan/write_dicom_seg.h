// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "voxel/scan/dicom_source.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

struct DicomSegOptions {
  std::string label = "Object";                 ///< the segment's name: 1 to 64 characters
  std::string series_description = "Octotomy";  ///< 1 to 64 characters
  /// The series that the object was made from. The segmentation takes over its patient, study and frame of
  /// reference, and each frame refers to the images behind it. None: a phantom in a study of its own.
  std::optional<DicomSource> source = std::nullopt;
  Progress progress;
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

}  // namespace octotomy::voxel
