// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/contour/contour.h"

namespace octotomy::brep {

/// A line on a lattice of samples: its start, and its steps, each to one of the eight neighbours. Steps are
/// numbered as by Freeman: 0 towards +x, then counter-clockwise with y up.
struct ChainCode {
  glm::ivec2 start{0};
  std::vector<std::uint8_t> steps;
  bool closed = true;
};

/// The chain of samples (i, j) * spacing_mm along a contour: its points rounded to samples and joined by
/// straight digital lines. Corners that are only due to rounding are removed. The chain passes within one
/// sample, along each axis, of every point. Throws std::invalid_argument if the spacing is not positive or
/// the contour has no points; Error, Resource, if it takes more than 2^24 steps or lies more than 2^30
/// samples away. Cost: linear in the steps. Source: Freeman, "On the encoding of arbitrary geometric
/// configurations", 1961; lines by Bresenham, 1965.
ChainCode chain_code(const Contour& contour, const glm::dvec2& spacing_mm);

/// The contour through a chain's samples. Throws std::invalid_argument if a step is above 7 or a closed chain
/// does not end where it starts.
Contour contour_of(const ChainCode& code, const glm::dvec2& spacing_mm);

/// Length in samples: 0.948 for a straight and 1.340 for a diagonal step, which is unbiased on average over
/// all directions. Source: Proffitt and Rosen, "Metrication errors and coding efficiency of chain-encoding
/// schemes", CGIP 10, 1979.
double chain_length(const ChainCode& code);

}  // namespace octotomy::brep
