// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/dicom/dicom_attributes.h"
#include "voxel/scan/dicom_source.h"
#include "voxel/scan/write_scene.h"

// Attributes common to written images and segmentations.

namespace octotomy::voxel {

/// Patient Identity Removed.
constexpr DicomTag identity_removed_tag = 0x00120062;

/// Writes patient, study and frame of reference of the source, or those of a phantom in a new study, and the
/// series. If the source states that its identity was removed, also writes the code of the profile. Texts
/// remain in the source's character set, or are converted to UTF-8 if `in_utf8` is set. Throws Error (Input)
/// if the source's set cannot be converted.
void put_study(DicomAttributes& attributes, const DicomOptions& options, const DicomDigest& digest,
               bool in_utf8);

/// Writes references to the images from which an image or a frame was made (PS3.3, C.7.6.1 and C.7.6.16.2.6).
void put_source_images(DicomAttributes& attributes, const std::vector<DicomSource::Image>& images);

/// Writes references to the source's series and to those of its images that the written object refers to
/// (PS3.3, C.12.2).
void put_referenced_series(DicomAttributes& attributes, const std::string& series_uid,
                           const std::vector<DicomSource::Image>& images);

}  // namespace octotomy::voxel
