// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// The format of a picture by its first bytes, under the name of OpenImageIO's reader: png, jpeg, webp, tiff,
/// bmp, pnm, openexr or jpeg2000. Refuses what that reader takes at its word before a caller can look at it:
/// a PNG chunk longer than the file; a size in a JPEG, BMP or JPEG 2000 header for which more than
/// `most_bytes` are taken, a byte a sample or, of JPEG 2000, four; as many tiles of JPEG 2000; a BMP header
/// of a size that OpenImageIO does not know, of which it leaves the remaining fields uninitialised. Throws
/// std::invalid_argument with the reason, also where the format is none of these. Source: ISO/IEC 15948, 5.3;
/// ISO/IEC 10918-1, B.2.2; ISO/IEC 15444-1, A.5.1 and I.4; the readers of OpenImageIO 2.4, libjpeg and
/// OpenJPEG 2.5.
std::string check_picture_header(std::string_view bytes, std::size_t most_bytes);

/// The part of a file that check_picture_header() looks at: the beginning; of PNG, JPEG and JP2, whose parts
/// are found along the file, all of it. Empty if the file cannot be read.
std::string picture_header(const std::filesystem::path& path);

}  // namespace octotomy::voxel
