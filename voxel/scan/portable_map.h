// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string_view>

#include "voxel/scan/image_file_oiio.h"

namespace octotomy::voxel {

/// Reads a portable grey map, or a pixel map with equal channels (P2, P3, P5, P6), whose stated largest
/// sample is above 255. The samples are not stretched. Precondition: read_picture_header() accepted its
/// header. Throws std::invalid_argument with the reason if it is in colour, has a sample above the stated
/// largest, ends early, or claims more than `most_bytes`. Source: netpbm's pgm(5) and ppm(5).
StoredImage read_portable_map(std::string_view bytes, std::size_t most_bytes);

}  // namespace octotomy::voxel
