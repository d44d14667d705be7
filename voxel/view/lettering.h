// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/view/pen.h"

namespace octotomy::voxel {

// Letters made of strokes, for labels on pictures: they need no font, and the same text gives the same pixels
// everywhere.

/// The strokes of a line of text that starts at `start` on its baseline; capitals are cap_px high. Printable
/// ASCII has glyphs; every other code point of UTF-8 is drawn as an empty box.
std::vector<Polyline> strokes_of_text(const std::string& text, const glm::dvec2& start_px, double cap_px);

/// The width from the left edge of the first letter to the right edge of the last.
double text_width_px(const std::string& text, double cap_px);

/// The text if it fits into a width, otherwise its longest beginning that fits with three dots behind it;
/// empty if not even the dots fit. Never splits a code point of UTF-8.
std::string shortened(const std::string& text, double width_px, double cap_px);

}  // namespace octotomy::voxel
