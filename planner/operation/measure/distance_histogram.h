// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/measure/difference.h"

namespace octotomy::planner {

/// The colour of a signed distance: white at zero, red outside, blue inside; full at the range. The ends are
/// of like lightness, so that neither side looks the larger.
glm::u8vec3 distance_colour(double distance_mm, double range_mm);

struct HistogramPicture {
  glm::ivec2 size_px{900, 480};
  std::vector<std::uint8_t> rgb;  ///< sRGB, row by row from the top left
};

/// The histogram of signed distances in those colours, with its scales and the figures that sum it up.
/// Precondition: the histogram has a bin.
HistogramPicture draw_histogram(const brep::Difference& difference, double range_mm);

}  // namespace octotomy::planner
