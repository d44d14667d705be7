// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Removal of noise from a scene, by ITK's filters. The lattice stays; int16 stays int16, rounded to the
// nearest, halves upwards. Beyond the scene's faces and in its padding the border samples repeat; padding
// stays. All throw std::invalid_argument for label maps, because labels have no order or mean; Stopped. Same
// bits on any thread count.
namespace octotomy::voxel {

/// Replaces each sample by the median of the samples at most `radius` samples away along each axis. Removes
/// specks and keeps edges, but rounds corners. Throws std::invalid_argument if a radius is negative or above
/// 16. Memory: the result. Cost: the samples times the neighbourhood.
Scene median(const Scene& scene, const glm::ivec3& radius, const Progress& progress = {});

/// Convolution with a Gaussian of standard deviation `sigma_mm`, for any spacing. The weights are Lindeberg's
/// discrete Gaussian, whose variance is exact on samples (IEEE PAMI 12, 1990), cut off at a sum of 0.999.
/// Throws std::invalid_argument if sigma is not positive and finite, or is more than 32 samples. Memory: two
/// float copies.
Scene gaussian(const Scene& scene, double sigma_mm, const Progress& progress = {});

struct DiffusionOptions {
  int iterations = 5;  ///< 1 to 1000; each spreads by one sample
  /// The gradient of edges to keep, in units of the scan's root mean square gradient. Below 1 keeps weak
  /// edges too; above 3 smooths nearly as a Gaussian does.
  double conductance = 1.0;
  Progress progress{};
};
/// Diffusion that stops at edges (Perona and Malik, IEEE PAMI 12, 1990). Throws std::invalid_argument if an
/// option is out of its range. Memory: two float copies.
Scene diffuse(const Scene& scene, const DiffusionOptions& options);

}  // namespace octotomy::voxel
