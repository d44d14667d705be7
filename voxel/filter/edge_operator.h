// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Edge operators in three dimensions (thesis 2.3.2.2.2). Their results are scenes, for slices, windows and
// region growing. Beyond the scene's faces the border samples repeat, and padding is replaced by its nearest
// samples. The result is padded where the scene is. All throw std::invalid_argument for label maps; Stopped.
// Parallel, same bits on any thread count.
namespace octotomy::voxel {

/// The magnitude of the gradient, in sample units per millimetre, by Zucker and Hummel's operator (IEEE PAMI
/// 3, 1981): each of the 26 neighbours is weighted by the cosine of the angle between its direction and the
/// axis. The scale makes the gradient of a linear field exact on any lattice. Departure: the directions are
/// those of cubic voxels. Memory: the result, in float.
Scene zucker_hummel(const Scene& scene, const Progress& progress = {});

/// The Laplacian of the scene smoothed by a Gaussian, in sample units per square millimetre (Marr and
/// Hildreth, Proc. Royal Society B 207, 1980). It crosses zero at edges and is positive on their dark side.
/// Central differences of gaussian()'s result, exact for quadratic fields. Throws std::invalid_argument as
/// gaussian() does, and if the axes are not perpendicular. Memory: two float copies.
Scene marr_hildreth(const Scene& scene, double sigma_mm, const Progress& progress = {});

/// The magnitude of the gradient, in sample units per millimetre, by Roberts's operator in three dimensions.
/// Three faces of a cell meet at its first sample; the gradient fits the differences along their six
/// diagonals by least squares. Exact for linear fields on any lattice. Of the operators in this file, it
/// makes the narrowest edges, one cell wide, and smooths noise least. Values belong to the cells' middles, so
/// the result's lattice is shifted by half a voxel along each axis. Source: Roberts 1965, in three dimensions
/// after Liu, Computer Graphics and Image Processing 6, 1977. Departure: the fit, in place of the largest
/// difference. Memory: the result, in float.
Scene roberts(const Scene& scene, const Progress& progress = {});

/// The magnitude of the gradient, in sample units per millimetre, of the linear function fitted by least
/// squares to the 27 samples around each sample: Prewitt's operator in three dimensions (Morgenthaler and
/// Rosenfeld, IEEE PAMI 3, 1981). Exact for linear fields on any lattice. Memory: the result, in float.
Scene prewitt(const Scene& scene, const Progress& progress = {});

/// The scene smoothed by the wider of two Gaussians minus the scene smoothed by the narrower, divided by half
/// the difference of their variances. Approximates marr_hildreth() in the same unit and with the same sign;
/// exact for quadratic fields, sheared lattices included. `sigma_mm` is the narrower standard deviation and
/// `ratio` the wider one divided by it; a ratio of 1.6 approximates best (Marr and Hildreth 1980). Throws
/// std::invalid_argument unless the ratio is finite and above 1, and as gaussian() does for either width.
/// Memory: three float copies.
Scene difference_of_gaussians(const Scene& scene, double sigma_mm, double ratio = 1.6,
                              const Progress& progress = {});

}  // namespace octotomy::voxel
