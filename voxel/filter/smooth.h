// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Removal of noise from a scene, by ITK's filters. The result has the scene's lattice and sample type; int16
// samples are rounded to the nearest integer, halves upwards. Beyond the scene's faces and in its padding the
// border samples repeat; the result is padded where the scene is. All throw std::invalid_argument for label
// maps, because labels have no order or mean; Stopped. Same bits on any thread count.
namespace octotomy::voxel {

/// Replaces each sample by the median of the samples at most `radius` samples away along each axis. Removes
/// specks and keeps edges, but rounds corners. Throws std::invalid_argument if a radius is negative or above
/// 16. Memory: the result. Cost: the number of samples times that of the neighbourhood's samples.
Scene median(const Scene& scene, const glm::ivec3& radius, const Progress& progress = {});

/// Convolution with a Gaussian of standard deviation `sigma_mm`; spacings may differ between axes. The
/// weights are Lindeberg's discrete Gaussian, whose variance is exact on samples (IEEE PAMI 12, 1990), cut
/// off at a sum of 0.999. Throws std::invalid_argument if sigma is not positive and finite, or exceeds 32
/// samples. Memory: two float copies.
Scene gaussian(const Scene& scene, double sigma_mm, const Progress& progress = {});

struct DiffusionOptions {
  int iterations = 5;  ///< number of iterations, 1 to 1000; each extends the smoothing by one sample
  /// The least gradient of edges that are kept, in units of the scan's root mean square gradient. Values
  /// below 1 keep weak edges too; values above 3 smooth nearly like a Gaussian.
  double conductance = 1.0;
  Progress progress{};
};
/// Diffusion that stops at edges (Perona and Malik, IEEE PAMI 12, 1990). Throws std::invalid_argument if an
/// option is out of its range. Memory: two float copies.
Scene diffuse(const Scene& scene, const DiffusionOptions& options);

}  // namespace octotomy::voxel
