// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "voxel/dicom/dicom_slice.h"

namespace octotomy::voxel {

/// Facts about a slice's values, found while decoding it.
struct DecodedSlice {
  bool fits = true;  ///< every value is an integer in the range of the sample type
  /// Number of pixels with bits set outside the stored bits, other than copies of the sign.
  std::size_t foreign_count = 0;
};

/// Whether two images have the same stored bytes of pixels in the same format. Throws Error (Input) if a file
/// has changed.
bool same_pixels(const DicomSlice& a, const DicomSlice& b);

/// Decodes a slice and applies its Modality LUT or its rescale, row by row, x fastest. A slope that is absent
/// or 0 is read as 1, an absent intercept as 0. Pixels of padding become `padding_mark` if there is one; a
/// measured value at or below the mark then makes `fits` false. Precondition: `samples` has a place for every
/// pixel. Throws Error (Input) with path and reason if the pixels cannot be decoded.
DecodedSlice read_dicom_samples(const DicomSlice& slice, std::span<std::int16_t> samples,
                                std::optional<std::int16_t> padding_mark = std::nullopt);
/// Decodes to single precision.
DecodedSlice read_dicom_samples(const DicomSlice& slice, std::span<float> samples,
                                std::optional<float> padding_mark = std::nullopt);

}  // namespace octotomy::voxel
