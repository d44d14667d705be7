// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::voxel {

/// Encodes 8-bit sRGB pixels, row by row from the top left, as a PNG picture. Preconditions: the size is
/// positive and matches the number of pixels. Throws Error (Resource) if the picture is too large for zlib.
/// Produces the same bytes as OpenImageIO at compression level 3, without the 0.2 s that loading OpenImageIO
/// takes. Compared with the highest compression level, files are a tenth larger and encoding takes a third of
/// the time. Cost: linear, about 20 ms per million pixels.
std::vector<std::uint8_t> encode_png(const glm::ivec2& size_px, const std::vector<std::uint8_t>& rgb);

}  // namespace octotomy::voxel
