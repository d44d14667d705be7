// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

struct BiasFieldOptions {
  /// Samples above this threshold determine the field. It is in the scan's unit and at least 0. None: Otsu's
  /// threshold between two classes is used as a guess.
  std::optional<double> threshold = {};
  double knots_mm = 200.0;  ///< largest distance between the first level's knots, above 0
  int levels = 4;           ///< number of levels, 1 to 6; each level halves the distance between the knots
  int iterations = 50;      ///< largest number of iterations in a level, 1 to 1000
  double noise = 0.01;      ///< noise that the Wiener filter assumes when it sharpens the histogram, above 0
  Progress progress{};
};

/// A scan from which the gradual change of brightness caused by an inhomogeneous magnetic field was removed.
struct BiasCorrection {
  Scene scene;             ///< in single precision: each sample divided by the field at its place
  double threshold = 0.0;  ///< the threshold used
  /// Range of the field at the fitted samples; the field's geometric mean there is 1.
  double field_low = 1.0, field_high = 1.0;
  std::size_t fitted = 0;  ///< number of samples to which the field was fitted
};

/// N4 (Tustison et al., IEEE Trans. Medical Imaging 29, 2010) by ITK, on a thinned scan with four samples
/// between the finest knots. The field, a cubic B-spline, is evaluated at every sample of the scan.
/// Departure: the field is scaled to a geometric mean of 1, so that samples keep their level. Throws
/// InvalidInput for label maps, for scans in Hounsfield units, because no magnetic field changes these, and
/// for options out of range; Error (Geometry) if fewer than 100 of the thinned samples are above the
/// threshold or a corrected sample would be too large for single precision; Stopped. Same bits on any thread
/// count: the fit runs in one thread, because ITK's sums depend on the number of threads. Memory: the result.
BiasCorrection correct_bias_field(const Scene& scene, const BiasFieldOptions& options);

}  // namespace octotomy::voxel
