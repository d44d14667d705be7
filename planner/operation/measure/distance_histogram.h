// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/measure/difference.h"

namespace octotomy::planner {

/// The colour of a signed distance: white at zero, red outside, blue inside, saturated at the range. Both
/// colours have similar lightness, so that neither side looks larger.
glm::u8vec3 distance_colour(double distance_mm, double range_mm);

struct HistogramPicture {
  glm::ivec2 size_px{900, 480};
  std::vector<std::uint8_t> rgb;  ///< sRGB, row by row from the top left corner
};

/// The histogram of signed distances in these colours, with scales and summary figures. Precondition: the
/// histogram has a bin.
HistogramPicture draw_histogram(const brep::Difference& difference, double range_mm);

}  // namespace octotomy::planner
