// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/progress.h"
#include "voxel/scene.h"

// Noise taken out of a scene, by ITK's filters. The scene's lattice stays; int16 stays int16, rounded to the
// nearest, halves upwards. At the faces samples repeat. Label maps are refused with std::invalid_argument, as
// their numbers have no order or mean. Each throws Stopped. Same bits on any thread count.
namespace octotomy::voxel {

/// The middle one of the samples at most `radius` away along each axis, in samples. Removes specks and keeps
/// edges, but rounds corners off. Throws std::invalid_argument where a radius is negative or above 16.
/// Memory: the result. Cost: the samples times the neighbourhood.
Scene median(const Scene& scene, const glm::ivec3& radius, const Progress& progress = {});

/// The convolution with a Gaussian of that standard deviation in millimetres, whatever the spacing; its
/// weights are Lindeberg's for samples, whose variance is exactly that (IEEE PAMI 12, 1990), cut off where
/// they sum to 0.999. Throws std::invalid_argument where sigma is not positive and finite, or is more than 32
/// samples. Memory: two float copies.
Scene gaussian(const Scene& scene, double sigma_mm, const Progress& progress = {});

struct DiffusionOptions {
  int iterations = 5;  ///< 1 to 1000: each reaches one sample further
  /// How steep an edge must be to stand: in root mean square gradients of the scan. Below 1 keeps weak edges,
  /// above 3 smooths nearly as a Gaussian does.
  double conductance = 1.0;
  Progress progress{};
};
/// Diffusion that edges hold up (Perona and Malik, IEEE PAMI 12, 1990). Throws std::invalid_argument where an
/// option is out of its range. Memory: two float copies.
Scene diffuse(const Scene& scene, const DiffusionOptions& options);

}  // namespace octotomy::voxel
