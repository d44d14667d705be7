// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/view/camera.h"

namespace octotomy::voxel {

/// One number per pixel, row by row from the top left.
struct RayImage {
  glm::ivec2 size_px{0};
  std::vector<float> values;
};

/// The largest trilinear sample along every pixel's ray, at steps of half a voxel; the value of the
/// background if a ray misses the universe. Skips cubes whose range cannot raise the maximum. Precondition:
/// an orthographic plane of the grey octree's universe. Throws Stopped. Parallel over rows; same bits on any
/// thread count.
RayImage maximum_intensity(const GreyOctree& grey, const ImagePlane& plane, const Progress& progress = {});

/// A factor for the attenuation of the samples in a range, ends included, in a radiograph: with 0 they
/// vanish, above 1 they stand out. Samples in no range have the factor 1; where ranges overlap, the first
/// applies.
struct RangeWeight {
  static constexpr double max_weight = 100.0;
  double low = 0.0;
  double high = 0.0;
  double weight = 0.0;  ///< 0 to max_weight
};
/// Throws std::invalid_argument if a range is empty or a weight beyond its limits.
void check(const std::vector<RangeWeight>& weights);

/// The attenuation of X-rays along the view: the line integral, without unit, of the linear attenuation
/// coefficient of samples in Hounsfield units, by the trapezoidal rule between the planes of voxels' centres
/// that a ray crosses, with bilinear samples in them (P. M. Joseph, IEEE Trans. Med. Imaging 1(3), 1982). Rays
/// are parallel, so that the picture is in true scale: from the side, a cephalogram without its enlargement.
/// Water attenuates by 0.0206 / mm, as at 60 keV (NIST XCOM). Samples of at most -1000 attenuate nothing.
/// With weights, each voxel's attenuation is first multiplied by the weight of the range that contains its
/// sample (Harris et al. 1979; thesis 4.4.2.3). The weight of a voxel that is part bone and part air follows
/// from its mean sample. Throws as maximum_intensity() and check() do; preconditions and threads are those of
/// maximum_intensity().
RayImage radiograph(const GreyOctree& grey, const ImagePlane& plane, const Progress& progress = {},
                    const std::vector<RangeWeight>& weights = {});

/// Values from `black` to `white` as grey tones, three bytes per pixel; white may be the lower value.
std::vector<std::uint8_t> grey_tones(const RayImage& image, double black, double white);

}  // namespace octotomy::voxel
