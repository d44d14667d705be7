// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// Refuses what OpenImageIO takes at its word before a caller can look at it: a PNG chunk longer than the
/// file; a JPEG 2000 codestream whose samples, four bytes each, or tiles take more than `most_bytes` to
/// decode; a BMP header of a size that it does not know, the rest of which it leaves as it was in memory.
/// Throws std::invalid_argument with the reason. Other bytes pass. Source: ISO/IEC 15948, 5.3; ISO/IEC
/// 15444-1, A.5.1; the formats' readers in OpenImageIO and OpenJPEG.
void check_picture_header(std::string_view bytes, std::size_t most_bytes);

/// The part of a file that check_picture_header() looks at: the beginning; of PNG and JP2, whose parts are
/// found along the file, all of it. Empty if the file cannot be read.
std::string picture_header(const std::filesystem::path& path);

}  // namespace octotomy::voxel
