// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/view/camera.h"
#include "voxel/view/cutaway.h"
#include "voxel/view/shade.h"
#include "voxel/view/transfer.h"

namespace octotomy::voxel {

struct CompositeOptions {
  TransferFunction transfer;
  std::vector<Cutaway> cuts;  ///< the parts to leave out
  std::vector<Light> lights;  ///< empty: those of Scenery
};

/// The light that arrives at every pixel from a volume, row by row from the top left.
struct Composite {
  glm::ivec2 size_px{0};
  std::vector<glm::vec4> light;  ///< linear light x, y, z and opacity w, without a background
  std::vector<float> depth_mm;   ///< the depth at which half of the light from behind is lost, or infinity
};

/// Volume rendering: samples as glowing, absorbing matter (Max, IEEE TVCG 1, 1995), composed front to back
/// (Levoy, ACM ToG 9, 1990) by the midpoint rule at steps of half a voxel's shortest edge. Matter whose
/// samples change is lit as a two-sided surface across their gradient (equation 5.3); matter within a voxel
/// behind a cut is lit as the cut's face. A ray ends once less than 1/1024 of the light from behind would
/// come through. Blocks and leaves without visible samples are skipped. Nothing is drawn beyond the scan.
/// Precondition: the plane is of the grey octree's universe. Throws as check(TransferFunction) does, and
/// Stopped. Parallel over rows; same bits on any thread count.
Composite composite(const GreyOctree& grey, const ImagePlane& plane, const CompositeOptions& options,
                    const Progress& progress = {});

/// The picture over a background (sRGB 0..1), 8-bit sRGB.
std::vector<std::uint8_t> over(const Composite& composite, const glm::vec3& background);

}  // namespace octotomy::voxel
