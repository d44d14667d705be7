// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/view/camera.h"

namespace octotomy::voxel {

/// A picture with one number per pixel, row by row from the top left.
struct RayImage {
  glm::ivec2 size_px{0};
  std::vector<float> values;
};

/// The largest trilinear sample along every pixel's ray, in the scan's unit, at steps of at most half a
/// voxel; the background's value if a ray misses the universe. Cubes whose range cannot raise the maximum are
/// skipped. Precondition: the plane is orthographic and has the grey octree's universe. Throws Stopped.
/// Parallel over rows; same bits on any thread count.
RayImage maximum_intensity(const GreyOctree& grey, const ImagePlane& plane, const Progress& progress = {});

/// A factor for the attenuation of the samples in a range, ends included, in a radiograph: at 0 the samples
/// are invisible, above 1 they are emphasised. Samples in no range have the factor 1; where ranges overlap,
/// the first applies.
struct RangeWeight {
  static constexpr double max_weight = 100.0;
  double low = 0.0;
  double high = 0.0;
  double weight = 0.0;  ///< 0 to max_weight
};
/// Throws std::invalid_argument if a range is empty or a weight is outside its limits.
void check(const std::vector<RangeWeight>& weights);

/// The attenuation of X-rays along the view: the line integral, without unit, of the linear attenuation
/// coefficient of samples in Hounsfield units, by the trapezoidal rule between the planes of voxels' centres
/// that a ray crosses, with samples interpolated bilinearly in the planes (P. M. Joseph, IEEE Trans. Med.
/// Imaging 1(3), 1982). Rays are parallel, so that the picture is in true scale: from the side, a cephalogram
/// without its enlargement. Water attenuates by 0.0206 / mm, as at 60 keV (NIST XCOM). Samples of at most
/// -1000 attenuate nothing. With weights, each voxel's attenuation is first multiplied by the weight of the
/// range that contains its sample (Harris et al. 1979; thesis 4.4.2.3). The weight of a voxel that is part
/// bone and part air follows from its mean sample. Throws as maximum_intensity() and check() do.
/// Preconditions are those of maximum_intensity(); also parallel over rows, with the same bits on any thread
/// count.
RayImage radiograph(const GreyOctree& grey, const ImagePlane& plane, const Progress& progress = {},
                    const std::vector<RangeWeight>& weights = {});

/// Converts values from `black` to `white` to grey tones, three bytes per pixel. `white` may be the lower
/// value.
std::vector<std::uint8_t> grey_tones(const RayImage& image, double black, double white);

}  // namespace octotomy::voxel
