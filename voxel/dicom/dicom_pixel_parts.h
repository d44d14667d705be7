// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "voxel/dicom/dicom_slice.h"

// Where in its file an image's pixels lie, and how they are stored.
namespace octotomy::voxel {

/// The storage of an image's pixels as the header states it, without the places of the pixels.
DicomPixels pixels_of(const DicomFile& file);
/// Whether pixels can be stored so: the bits of a value lie within those that are allocated.
bool is_sound(const DicomPixels& pixels);

/// The lossy compression of an image's pixels, from its transfer syntax and LossyImageCompression; empty: lossless.
std::string lossy_of(const DicomFile& file);

/// The largest number of frames that the pixels can hold: one per fragment, or as many as their bytes suffice
/// for.
std::size_t most_frames(const DicomFile& file, const DicomSlice& slice);

/// Fills the places of the pixels of `slices`, the frames of a file. Returns the reason if they cannot be grey
/// frames.
std::optional<NoSlice> take_pixels(const DicomFile& file, std::vector<DicomSlice>& slices);

}  // namespace octotomy::voxel
