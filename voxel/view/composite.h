// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/view/camera.h"
#include "voxel/view/cutaway.h"
#include "voxel/view/shade.h"
#include "voxel/view/transfer.h"

namespace octotomy::voxel {

/// Opacity from density and gradient (Levoy, IEEE CG&A 8(3), 1988; thesis 4.4.2.3): the transfer function's
/// extinction counts only where samples change, so that surfaces show and the insides of tissues do not.
/// Departure from Levoy: one ramp of the gradient's length for all samples.
struct GradientOpacity {
  double clear_per_mm = 0.0;   ///< samples that change by at most this much per mm are clear; 0 or more
  double opaque_per_mm = 1.0;  ///< from this change per mm on, all of the extinction counts; above
                               ///< clear_per_mm

  double share(double slope_per_mm) const;  ///< share of the extinction that counts, 0..1
};
/// Throws std::invalid_argument unless 0 <= clear_per_mm < opaque_per_mm, both finite.
void check(const GradientOpacity& gradient);

struct CompositeOptions {
  TransferFunction transfer;
  std::vector<Cutaway> cuts;  ///< the parts to leave out
  std::vector<Light> lights;  ///< empty: those of Scenery
  float ambient = Scenery{}.ambient;
  std::optional<GradientOpacity> gradient{};  ///< none: opacity from density alone
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
/// Precondition: the plane is of the grey octree's universe. Throws as check() of its transfer function and
/// gradient does, and Stopped. Parallel over rows; same bits on any thread count.
Composite composite(const GreyOctree& grey, const ImagePlane& plane, const CompositeOptions& options,
                    const Progress& progress = {});

/// The picture over a background (sRGB 0..1), 8-bit sRGB.
std::vector<std::uint8_t> over(const Composite& composite, const glm::vec3& background);

}  // namespace octotomy::voxel
