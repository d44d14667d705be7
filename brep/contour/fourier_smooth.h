// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "brep/contour/contour.h"

namespace octotomy::brep {

struct FourierOptions {
  std::size_t harmonics = 16;  ///< kept either way round, at least 1: one gives an ellipse
  std::size_t points = 128;    ///< of the result, evenly in arc length of the original; above 2 * harmonics
};

/// A closed contour from its lowest Fourier harmonics in arc length, their coefficients integrated exactly
/// over the polygon, but for rounding. Corners have harmonics without end: there is no number beyond which
/// more change nothing. Throws std::invalid_argument where open, of no length, or an option is out of its
/// range. Cost: n log n in points and harmonics. Source: Kuhl and Giardina, "Elliptic Fourier features of a
/// closed contour", CGIP 18, 1982, in complex numbers.
Contour fourier_smooth(const Contour& contour, const FourierOptions& options = {});

}  // namespace octotomy::brep
