// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/view/pen.h"

namespace octotomy::voxel {

// Letters made of strokes, for labels on pictures. They need no font, and the same text yields the same
// pixels on every machine.

/// The strokes, in pixel positions, of a line of text whose baseline begins at `start`; capitals are cap_px
/// high. Printable ASCII has glyphs; every other code point of UTF-8 is drawn as an empty box.
std::vector<Polyline> strokes_of_text(const std::string& text, const glm::dvec2& start_px, double cap_px);

/// The width in pixels of a line of text, from the left edge of the first letter to the right edge of the
/// last.
double text_width_px(const std::string& text, double cap_px);

/// The text if it fits into a width, otherwise the longest beginning of the text that fits together with
/// three dots; empty if not even the dots fit. Never splits a code point of UTF-8.
std::string shortened(const std::string& text, double width_px, double cap_px);

}  // namespace octotomy::voxel
