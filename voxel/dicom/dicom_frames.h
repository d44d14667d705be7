// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "voxel/dicom/dicom_slice.h"

// Positions and traits of frames in files without attributes for each frame: films and nuclear medicine
// images.
namespace octotomy::voxel {

bool is_nuclear(const std::string& class_uid);

/// The reason why the frames of a nuclear medicine image are not reconstructed slices; none if they are.
std::optional<NoSlice> not_reconstructed(const DicomFile& file, std::size_t frames);

/// For each frame of a nuclear medicine image, the item of its detector, which contains the frame's position;
/// empty if there is no such item.
std::vector<DicomFile> detectors_of_frames(const DicomFile& file, std::size_t frames);

/// Stores time slots, energy windows and similar numbers of a nuclear medicine image's frames as traits of
/// the slices, so that frames at one position are split into stacks.
void take_frame_vectors(const DicomFile& file, std::vector<DicomSlice>& slices);

/// Computes positions for frames that have none. Frames follow each other along the normal, beginning at the
/// first frame. Returns a reason if the header states no distances between frames.
std::optional<NoSlice> place_frames(const DicomFile& file, std::vector<DicomSlice>& slices);

}  // namespace octotomy::voxel
