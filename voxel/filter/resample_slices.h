// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Resamples a scene to another spacing of slices along the lattice's third axis (thesis 2.2.3).
namespace octotomy::voxel {

/// The interpolation between slices: the nearest; linear; cubic convolution of four slices (Keys 1981,
/// a = -1/2); Lanczos's windowed sinc over six slices (Turkowski, Graphics Gems I, 1990), its weights scaled
/// to sum to 1. Cubic and Lanczos overshoot at edges. Beyond the first and the last slice these slices
/// repeat. All kernels except the nearest blur between distant slices; no kernel adds detail that was not
/// sampled.
enum class SliceKernel { Nearest, Linear, Cubic, Lanczos };

/// A lattice with slices at another spacing, from the first slice up to the last. Throws
/// std::invalid_argument if the spacing is not positive and finite, or if the result would have more than
/// 2^16 slices.
Lattice with_slice_spacing(const Lattice& lattice, double spacing_mm);

/// The scene resampled to the lattice of with_slice_spacing(). int16 samples remain int16, rounded to the
/// nearest integer, halves upwards, and clamped to the type's range. A sample that would depend on padding is
/// padding. Samples are not smoothed before a wider spacing is used; average_down() averages them. Throws
/// std::invalid_argument as with_slice_spacing(), and for a label map unless the kernel is Nearest; Error
/// (Resource) as need_memory(); Stopped. Parallel, same bits on any thread count. Memory: the result.
Scene resample_slices(const Scene& scene, double spacing_mm, SliceKernel kernel,
                      const Progress& progress = {});

struct ShapeOptions {
  double spacing_mm = 1.0;  ///< of the new slices
  double low = 0.0;         ///< the object consists of the samples from low to high, both included
  double high = 32767.0;
  Progress progress{};
};
/// The object of a window, interpolated between slices by its shape. For each slice the distances to the
/// object's outline are computed, negative inside. Between two slices these distances are interpolated
/// linearly, and a sample is in the object if its distance is at most 0 (Raya and Udupa, IEEE Trans. Medical
/// Imaging 9, 1990; departure: distances are Euclidean and exact instead of chamfered). At a sampled slice
/// the result is exactly that slice's shape. Between an empty slice and another one the result is the shape
/// in the nearer slice, or in the lower slice at equal distances. The result is a label map of 0 and 1 on
/// with_slice_spacing(). Throws as resample_slices(), and std::invalid_argument if the first two axes are not
/// perpendicular. Parallel over slices. Memory: the result, and two slices of floats per thread.
Scene interpolate_shape(const Scene& scene, const ShapeOptions& options);

}  // namespace octotomy::voxel
