// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "voxel/dicom/dicom_slice.h"

// Frames of files that have no attributes for each frame: films and images of nuclear medicine.
namespace octotomy::voxel {

bool is_nuclear(const std::string& class_uid);

/// The reason why a nuclear medicine image has no reconstructed slices; none if it has them.
std::optional<NoSlice> not_reconstructed(const DicomFile& file, std::size_t frames);

/// For each frame of a nuclear medicine image, the item of its detector, which holds its position; empty if
/// there is none.
std::vector<DicomFile> detectors_of_frames(const DicomFile& file, std::size_t frames);

/// Stores time slots, energy windows and similar numbers of a nuclear medicine image's frames as traits, by
/// which frames at one position are separated into stacks.
void take_frame_vectors(const DicomFile& file, std::vector<DicomSlice>& slices);

/// Computes positions for frames that have none: along the normal, starting at the first frame. Returns the
/// reason if the header states no distances between frames.
std::optional<NoSlice> place_frames(const DicomFile& file, std::vector<DicomSlice>& slices);

}  // namespace octotomy::voxel
