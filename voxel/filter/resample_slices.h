// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Slices at another spacing along the slice axis, the lattice's third (thesis 2.2.3).
namespace octotomy::voxel {

/// The interpolation between slices: the nearest; linear; cubic convolution of four slices (Keys 1981,
/// a = -1/2); Lanczos's windowed sinc over six slices (Turkowski, Graphics Gems I, 1990), its weights scaled
/// to sum to 1. Cubic and Lanczos overshoot at edges. Beyond the first and last slice these repeat. All but
/// the nearest blur between slices that are far apart; none adds detail that was not sampled.
enum class SliceKernel { Nearest, Linear, Cubic, Lanczos };

/// A lattice with slices at another spacing, from the first slice up to the last. Throws
/// std::invalid_argument if the spacing is not positive and finite, or would take more than 2^16 slices.
Lattice with_slice_spacing(const Lattice& lattice, double spacing_mm);

/// The scene on with_slice_spacing(). int16 stays int16, rounded to the nearest, halves upwards, and clamped
/// to its range. A sample that would depend on padding is padding. Does not smooth before a wider spacing;
/// average_down() does. Throws std::invalid_argument as with_slice_spacing(), and for a label map unless the
/// kernel is Nearest; Error (Resource) as need_memory(); Stopped. Parallel, same bits on any thread count.
/// Memory: the result.
Scene resample_slices(const Scene& scene, double spacing_mm, SliceKernel kernel,
                      const Progress& progress = {});

struct ShapeOptions {
  double spacing_mm = 1.0;  ///< of the new slices
  double low = 0.0;         ///< the object's samples are low to high, both included
  double high = 32767.0;
  Progress progress{};
};
/// The object of a window with its slices interpolated by shape. Each slice has a map of the distance to the
/// object's outline in it, negative inside; between two slices the maps are interpolated linearly, and the
/// object is the set of distances of at most 0 (Raya and Udupa, IEEE Trans. Medical Imaging 9, 1990;
/// departure: distances are Euclidean and exact instead of chamfered). At a sampled slice the result is that
/// slice's own shape. Next to an empty slice the result is the nearer slice's shape, at equal distance the
/// lower slice's. The result is a label map of 0 and 1 on with_slice_spacing(). Throws as resample_slices(),
/// and std::invalid_argument if the first two axes are not perpendicular. Parallel over slices. Memory: the
/// result, and two slices of floats per thread.
Scene interpolate_shape(const Scene& scene, const ShapeOptions& options);

}  // namespace octotomy::voxel
