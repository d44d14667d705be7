// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// Header facts that OpenImageIO needs from the caller or does not report.
struct PictureHeader {
  std::string format;  ///< name of OpenImageIO's reader: png, jpeg, webp, tiff, bmp, pnm, openexr or jpeg2000
  /// The largest value that a sample may have, if OpenImageIO's reader stretches samples to their type's full
  /// range without reporting this; else 0.
  std::uint32_t largest_sample = 0;
};

/// Reads a header from a file's first bytes. Refuses claims on which the format's reader would act before its
/// caller can check them: a PNG chunk longer than the file; a size in a JPEG or JPEG 2000 header that needs
/// more than `most_bytes` (one byte a sample, four for JPEG 2000); too many tiles of JPEG 2000. Refuses
/// pictures that the reader decodes wrongly: signed samples of JPEG 2000; a run-length-encoded BMP, or one
/// with a header of unknown size. Throws std::invalid_argument with the reason, also for any other format.
/// Source: ISO/IEC 15948, 5.3 and 11.2.2; ISO/IEC 10918-1, B.2.2; ISO/IEC 15444-1, A.5.1 and I.4; netpbm's
/// pgm(5); the readers of OpenImageIO 2.4, libjpeg and OpenJPEG 2.5.
PictureHeader read_picture_header(std::string_view bytes, std::size_t most_bytes);

/// The part of a file that read_picture_header() reads: the beginning, or the whole file for PNG, JPEG and
/// JP2, whose parts are spread over the file. Empty if the file cannot be read.
std::string picture_header_bytes(const std::filesystem::path& path);

}  // namespace octotomy::voxel
