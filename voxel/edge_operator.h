// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/progress.h"
#include "voxel/scene.h"

// Edge operators in three dimensions (thesis 2.3.2.2.2), whose answers are scenes: looked at in slices, grown
// in, or made objects of by a window. At the faces samples repeat. Both throw std::invalid_argument for label
// maps; Stopped. Parallel, same bits on any thread count.
namespace octotomy::voxel {

/// The length of the gradient, in sample units a millimetre, by Zucker and Hummel's operator (IEEE PAMI 3,
/// 1981): each of the 26 neighbours weighs by the cosine of its direction's angle to the axis. Scaled so that
/// a linear field's gradient is exact, on any lattice; departure: directions are those of cubic voxels.
/// Memory: the result, in float.
Scene zucker_hummel(const Scene& scene, const Progress& progress = {});

/// The Laplacian of the scene smoothed by a Gaussian, in sample units a square millimetre (Marr and Hildreth,
/// Proc. Royal Society B 207, 1980): edges are where it passes through zero; it is positive on their dark
/// side. By central differences of gaussian()'s answer, so that quadratics are exact. Throws
/// std::invalid_argument as gaussian(), and where axes are not at right angles. Memory: two float copies.
Scene marr_hildreth(const Scene& scene, double sigma_mm, const Progress& progress = {});

}  // namespace octotomy::voxel
