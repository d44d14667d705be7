// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/pen.h"

namespace octotomy::voxel {

// Letters made of strokes, for labels on pictures: no font has to be installed, and the same text is the same
// pixels everywhere.

/// The strokes of a line of text whose first letter stands at `start`, on its baseline; capitals are cap_px
/// high. Printable ASCII has glyphs; every other code point of UTF-8 is drawn as an empty box.
std::vector<Polyline> strokes_of_text(const std::string& text, const glm::dvec2& start_px, double cap_px);

/// From the left edge of the first letter to the right edge of the last.
double text_width_px(const std::string& text, double cap_px);

/// The text, or as much of its beginning as fits into a width with three dots behind it; empty where not
/// even these fit. Never cuts a code point of UTF-8 in two.
std::string shortened(const std::string& text, double width_px, double cap_px);

}  // namespace octotomy::voxel
