// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "brep/contour/contour.h"

namespace octotomy::brep {

struct FourierOptions {
  std::size_t harmonics = 16;  ///< harmonics kept in either direction, at least 1; one makes an ellipse
  std::size_t points = 128;    ///< points of the result, evenly spaced in the original's arc length; above 2
                               ///< * harmonics
};

/// A closed contour from its lowest Fourier harmonics in arc length. Their coefficients are integrated
/// exactly over the polygon, up to rounding. Corners have infinitely many harmonics, so every further
/// harmonic changes the result. Throws std::invalid_argument if the contour is open or has no length, or an
/// option is out of its range. Cost: n log n in points and harmonics. Source: Kuhl and Giardina, "Elliptic
/// Fourier features of a closed contour", CGIP 18, 1982, in complex numbers.
Contour fourier_smooth(const Contour& contour, const FourierOptions& options = {});

}  // namespace octotomy::brep
