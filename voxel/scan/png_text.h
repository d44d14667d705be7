// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octotomy::voxel {

/// A PNG's bytes with a text chunk (tEXt) behind its header. Throws std::invalid_argument if the bytes are no
/// PNG. Precondition: keyword and text are ASCII, the keyword 1 to 79 characters.
std::vector<std::uint8_t> with_png_text(const std::vector<std::uint8_t>& png, const std::string& keyword,
                                        const std::string& text);

/// What a PNG says of itself.
struct PngText {
  glm::ivec2 size_px{0};
  std::optional<std::string> text;  ///< none: it has no such chunk
};
/// The size and the text of that keyword. Throws std::invalid_argument if the bytes are no PNG, or end
/// within a chunk.
PngText png_text(std::string_view bytes, const std::string& keyword);

}  // namespace octotomy::voxel
