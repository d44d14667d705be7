// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// What OpenImageIO is to be told of a picture, and does not tell of it.
struct PictureHeader {
  std::string format;  ///< its reader: png, jpeg, webp, tiff, bmp, pnm, openexr or jpeg2000
  /// The largest value that a sample may have, where the reader stretches samples over all values of their
  /// type and does not say so; else 0.
  std::uint32_t largest_sample = 0;
};

/// Reads a header by its first bytes. Refuses what the format's reader takes at its word before a caller can
/// look at it: a PNG chunk longer than the file; a size in a JPEG or JPEG 2000 header for which more than
/// `most_bytes` are taken, a byte a sample or, of JPEG 2000, four; as many tiles of JPEG 2000. Refuses what
/// it reads wrongly: signed samples of JPEG 2000; a BMP packed as runs, or with a header of a size that it
/// does not know. Throws std::invalid_argument with the reason, also where the format is none of these.
/// Source: ISO/IEC 15948, 5.3 and 11.2.2; ISO/IEC 10918-1, B.2.2; ISO/IEC 15444-1, A.5.1 and I.4; netpbm's
/// pgm(5); the readers of OpenImageIO 2.4, libjpeg and OpenJPEG 2.5.
PictureHeader read_picture_header(std::string_view bytes, std::size_t most_bytes);

/// The part of a file that read_picture_header() looks at: the beginning; of PNG, JPEG and JP2, whose parts
/// are found along the file, all of it. Empty if the file cannot be read.
std::string picture_header_bytes(const std::filesystem::path& path);

}  // namespace octotomy::voxel
