// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "voxel/dicom_source.h"
#include "voxel/octree.h"

namespace octotomy::voxel {

struct DicomSegOptions {
  std::string label = "Object";                 ///< of the segment, for people: 1 to 64 characters
  std::string series_description = "Octotomy";  ///< at most 64 characters
  /// The series that the object was made from: patient, study and frame of reference are taken over from it,
  /// and each frame refers to the images that it comes from. None: a study of its own.
  std::optional<DicomSource> source = std::nullopt;
  std::stop_token stop;
};

/// Writes an object as a DICOM segmentation: one binary segment, a frame each plane of voxels along the
/// universe's third axis that holds one, cropped to the object across it. The voxels are the octree's own:
/// none is resampled to the source's lattice. Unique identifiers come from the content: the same object and
/// options give the same bytes. Written beside and renamed into place.
/// Throws std::invalid_argument where the object is empty, the universe's axes are not perpendicular or a
/// text is too long; std::runtime_error with path and reason; Stopped. Cost: the planes' pixels; memory: one
/// bit a pixel, twice.
void write_dicom_seg(const Octree& object, const std::filesystem::path& path,
                     const DicomSegOptions& options = {});

}  // namespace octotomy::voxel
