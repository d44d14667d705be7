// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "voxel/camera.h"
#include "voxel/grey_octree.h"

namespace octotomy::voxel {

/// A number a pixel, row by row from the top left.
struct RayImage {
  glm::ivec2 size_px{0};
  std::vector<float> values;
};

/// The largest sample along every pixel's ray, trilinear, at steps of half a voxel; the background's value
/// where a ray misses the universe. Blocks whose range cannot raise it are stepped over.
/// Precondition: the plane is of the grey octree's universe. Stopped, it throws std::runtime_error. Parallel
/// over rows; same bits on any thread count.
RayImage maximum_intensity(const GreyOctree& grey, const ImagePlane& plane, const std::stop_token& stop = {});

/// What X-rays along the view lose: the line integral of the linear attenuation coefficient of samples in
/// Hounsfield units, without unit, by the trapezoidal rule at steps of half a voxel. Rays are parallel, so
/// that the picture is in true scale: from the side, a cephalogram without its enlargement.
/// Attenuation of water: 0.0206 / mm, that at 60 keV (NIST XCOM). Air and less attenuate nothing. Otherwise
/// as maximum_intensity().
RayImage radiograph(const GreyOctree& grey, const ImagePlane& plane, const std::stop_token& stop = {});

/// Values between `black` and `white` as grey tones, three bytes a pixel; white may be the lower one.
std::vector<std::uint8_t> grey_tones(const RayImage& image, double black, double white);

}  // namespace octotomy::voxel
