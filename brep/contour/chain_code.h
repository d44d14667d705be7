// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/contour/contour.h"

namespace octotomy::brep {

/// A line on a lattice of samples: where it starts and its steps to one of the eight neighbours each, 0
/// towards +x and on counter-clockwise with y up, as Freeman numbers them.
struct ChainCode {
  glm::ivec2 start{0};
  std::vector<std::uint8_t> steps;
  bool closed = true;
};

/// The chain of the samples along a contour, points (i, j) * spacing_mm: its points rounded to samples and
/// joined by straight digital lines, with corners cut that only rounding made. It passes every point within a
/// sample along each axis. Throws std::invalid_argument where the spacing is not positive or the contour has
/// no points; Error, Resource, where it takes more than 2^24 steps or lies more than 2^30 away. Cost: linear
/// in the steps. Source: Freeman, "On the encoding of arbitrary geometric configurations", 1961; lines by
/// Bresenham, 1965.
ChainCode chain_code(const Contour& contour, const glm::dvec2& spacing_mm);

/// The contour through a chain's samples. Throws std::invalid_argument where a step is above 7 or a closed
/// chain does not end where it starts.
Contour contour_of(const ChainCode& code, const glm::dvec2& spacing_mm);

/// Length in samples by the two kinds of steps, 0.948 and 1.340 for straight and diagonal, which are right on
/// the average of all directions. Source: Proffitt and Rosen,
/// "Metrication errors and coding efficiency of chain-encoding schemes", CGIP 10, 1979.
double chain_length(const ChainCode& code);

}  // namespace octotomy::brep
