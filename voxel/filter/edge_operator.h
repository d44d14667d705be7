// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Edge operators in three dimensions (thesis 2.3.2.2.2). Their results are scenes, for slices, windows and
// region growing. Beyond the scene's faces and in its padding the border samples repeat; padding stays. Both
// throw std::invalid_argument for label maps; Stopped. Parallel, same bits on any thread count.
namespace octotomy::voxel {

/// The length of the gradient, in sample units per millimetre, by Zucker and Hummel's operator (IEEE PAMI 3,
/// 1981): each of the 26 neighbours is weighted by the cosine of the angle between its direction and the
/// axis. The scale makes the gradient of a linear field exact on any lattice. Departure: the directions are
/// those of cubic voxels. Memory: the result, in float.
Scene zucker_hummel(const Scene& scene, const Progress& progress = {});

/// The Laplacian of the scene smoothed by a Gaussian, in sample units per square millimetre (Marr and
/// Hildreth, Proc. Royal Society B 207, 1980). It crosses zero at edges and is positive on their dark side.
/// Central differences of gaussian()'s result, exact for quadratic fields. Throws std::invalid_argument as
/// gaussian(), and if the axes are not perpendicular. Memory: two float copies.
Scene marr_hildreth(const Scene& scene, double sigma_mm, const Progress& progress = {});

}  // namespace octotomy::voxel
