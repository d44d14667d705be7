// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace octotomy::voxel {

bool is_ascii(std::string_view text);

/// Converts a text from a DICOM character set to UTF-8. `character_set` is the value of (0008,0005); if it
/// has several values, the last is used (PS3.3, C.12.1.1.2). None if the set is unknown or the text is not
/// valid in it.
std::optional<std::string> utf8_of(std::string_view character_set, std::string_view text);

}  // namespace octotomy::voxel
