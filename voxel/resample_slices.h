// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/progress.h"
#include "voxel/scene.h"

// Slices at another spacing along the slice axis, the lattice's third (thesis 2.2.3).
namespace octotomy::voxel {

/// How a sample between slices is made of theirs: the nearest one; linear; cubic convolution of four slices
/// (Keys 1981, a = -1/2); Lanczos's windowed sinc over six slices (Turkowski, Graphics Gems I, 1990), its
/// weights scaled to sum to 1. Cubic and Lanczos overshoot at edges. Beyond the first and last slice these
/// repeat. All but the nearest blur where slices are far apart; none adds what was not sampled.
enum class SliceKernel { Nearest, Linear, Cubic, Lanczos };

/// The slices of a lattice at another spacing: the first where it was, and as many as lie at or before the
/// last. Throws std::invalid_argument where the spacing is not positive and finite, or would take more than
/// 2^16 slices.
Lattice with_slice_spacing(const Lattice& lattice, double spacing_mm);

/// The scene on with_slice_spacing(). int16 stays int16, rounded to the nearest, halves upwards, and cut off
/// at its range's ends. Wider spacings are not smoothed first: average_down() does that. Throws
/// std::invalid_argument as with_slice_spacing(), and where labels are to be mixed, for which there is
/// Nearest alone; Stopped. Parallel, same bits on any thread count. Memory: the result.
Scene resample_slices(const Scene& scene, double spacing_mm, SliceKernel kernel,
                      const Progress& progress = {});

struct ShapeOptions {
  double spacing_mm = 1.0;  ///< of the slices to be made
  double low = 0.0;         ///< the object is the samples from low to high, both included
  double high = 32767.0;
  Progress progress{};
};
/// The object that a window is, its slices interpolated by shape: on every slice the distance to the object's
/// outline in the slice, negative inside; between two slices the distances are interpolated linearly, and
/// the object is where that is at most 0 (Raya and Udupa, IEEE Trans. Medical Imaging 9, 1990; departure:
/// distances are Euclidean and exact instead of chamfered). Slices that are sampled stay as they are; next to
/// an empty slice the nearer slice's shape is taken, the sampled one at equal distance. The result is a label
/// map of 0 and 1 on with_slice_spacing(). Throws as resample_slices(), and std::invalid_argument where the
/// first two axes are not perpendicular. Parallel over slices. Memory: the result, and two slices of floats
/// a thread.
Scene interpolate_shape(const Scene& scene, const ShapeOptions& options);

}  // namespace octotomy::voxel
