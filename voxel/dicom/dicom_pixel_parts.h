// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "voxel/dicom/dicom_slice.h"

// Reads from a header where an image's pixels lie in the file, and how they are stored.
namespace octotomy::voxel {

/// The storage format of an image's pixels as the header states it, without the positions of the pixels.
DicomPixels pixels_of(const DicomFile& file);
/// Whether the storage format is consistent: the stored bits lie within the allocated bits.
bool is_sound(const DicomPixels& pixels);

/// The lossy compression of an image's pixels, as its transfer syntax or LossyImageCompression states it.
/// Empty: lossless.
std::string lossy_of(const DicomFile& file);

/// The largest number of frames that the pixel data can contain: one per fragment if the pixels are
/// compressed, otherwise the number of frames that fits into the bytes.
std::size_t most_frames(const DicomFile& file, const DicomSlice& slice);

/// Sets the positions of the pixels of `slices`, the frames of a file. Returns the reason if the pixels
/// cannot be grey frames.
std::optional<NoSlice> take_pixels(const DicomFile& file, std::vector<DicomSlice>& slices);

}  // namespace octotomy::voxel
