// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "voxel/camera.h"
#include "voxel/cut.h"
#include "voxel/shade.h"
#include "voxel/transfer.h"

namespace octotomy::voxel {

struct CompositeOptions {
  TransferFunction transfer;
  std::vector<Cut> cuts;  ///< nothing is seen of what they take away
  /// Towards which surfaces are shaded; none: those of Scenery.
  std::vector<Light> lights;
};

/// What light arrives at every pixel from a volume, row by row from the top left.
struct Composite {
  glm::ivec2 size_px{0};
  std::vector<glm::vec4> light;  ///< linear, of opaque share w: not yet over any background
  std::vector<float> depth_mm;   ///< where half of the light from behind is lost; infinity: nowhere
};

/// Volume rendering: samples as glowing, absorbing matter (Max, IEEE TVCG 1, 1995), composed front to back
/// (Levoy, ACM ToG 9, 1990) by the midpoint rule at steps of half a voxel's shortest edge. Where samples
/// change, light falls on them as on a surface against their gradient (equation 5.3), seen from either side;
/// a voxel deep behind a cut, as on the cut's face. A ray ends where less than 1/1024 of what lies behind
/// would come through. Blocks, down to leaves, in which the transfer function makes nothing visible are
/// stepped over. Precondition: the plane is of the grey octree's universe. Throws as check(TransferFunction);
/// stopped, it throws std::runtime_error. Parallel over rows; same bits on any thread count.
Composite composite(const GreyOctree& grey, const ImagePlane& plane, const CompositeOptions& options,
                    const std::stop_token& stop = {});

/// The picture over a background (sRGB 0..1), 8-bit sRGB.
std::vector<std::uint8_t> over(const Composite& composite, const glm::vec3& background);

}  // namespace octotomy::voxel
