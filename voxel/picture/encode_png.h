// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::voxel {

/// A PNG picture of 8-bit sRGB pixels, row by row from the top left. Preconditions: the size is positive and
/// that of the pixels. Throws Error (Resource) if it is larger than zlib takes. The same bytes as
/// OpenImageIO's at its compression level 3, a tenth larger than the best in a third of the time, without the
/// 0.2 s that loading it takes. Cost: linear, about 20 ms a million pixels.
std::vector<std::uint8_t> encode_png(const glm::ivec2& size_px, const std::vector<std::uint8_t>& rgb);

}  // namespace octotomy::voxel
