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
/// extinction is applied only where samples change, so that surfaces are visible and the insides of tissues
/// are not. Departure from Levoy: all samples use the same ramp of the gradient's magnitude.
struct GradientOpacity {
  double clear_per_mm = 0.0;  ///< samples that change by at most this much per mm are clear; 0 or more
  /// From this change per mm on, the full extinction is applied; above clear_per_mm.
  double opaque_per_mm = 1.0;

  double share(double slope_per_mm) const;  ///< share of the extinction that is applied, 0..1
};
/// Throws std::invalid_argument unless both numbers are finite and 0 <= clear_per_mm < opaque_per_mm.
void check(const GradientOpacity& gradient);

struct CompositeOptions {
  TransferFunction transfer;
  std::vector<Cutaway> cuts;  ///< the parts to leave out
  std::vector<Light> lights;  ///< empty: those of Scenery
  float ambient = Scenery{}.ambient;
  std::optional<GradientOpacity> gradient{};  ///< none: opacity depends only on density
};

/// The light that arrives at every pixel from a volume, row by row from the top left.
struct Composite {
  glm::ivec2 size_px{0};
  std::vector<glm::vec4> light;  ///< linear RGB light in x, y, z and opacity in w, without a background
  std::vector<float> depth_mm;   ///< the depth at which half of the light from behind is lost, or infinity
};

/// Volume rendering: samples as glowing, absorbing matter (Max, IEEE TVCG 1, 1995), composed front to back
/// (Levoy, ACM ToG 9, 1990) by the midpoint rule at steps of half a voxel's shortest edge. Where samples
/// change, matter is lit as a two-sided surface with the gradient as its normal (equation 5.3). Matter less
/// than a voxel behind a cut is lit as the cut's face. A ray ends when less than 1/1024 of the light from
/// behind would be transmitted. Blocks and leaves without visible samples are skipped. Nothing is drawn
/// beyond the scan. Precondition: the plane has the grey octree's universe. Throws as check() of the transfer
/// function and of the gradient do; Stopped. Parallel over rows; same bits on any thread count.
Composite composite(const GreyOctree& grey, const ImagePlane& plane, const CompositeOptions& options,
                    const Progress& progress = {});

/// The picture in 8-bit sRGB over a background, sRGB 0..1.
std::vector<std::uint8_t> over(const Composite& composite, const glm::vec3& background);

}  // namespace octotomy::voxel
