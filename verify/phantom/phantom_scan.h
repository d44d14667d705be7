// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "verify/phantom/measured_solid.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {

struct PhantomScanOptions {
  double blur_voxels = 0.0;  ///< deviation of a Gaussian along each axis, in voxels
  double noise_share = 0.0;  ///< deviation of the noise, as a share of the contrast of inside and outside
  /// Only the slices that the solid meets and seven more at both ends; false: the whole universe.
  bool near_slices_only = false;
};

/// A scan with samples from phantom_low (outside) to -phantom_low (inside): the filled share of each voxel of
/// the solid's universe, blurred, with noise. The half level is 0.
voxel::Scene phantom_scan(const voxel::PartialOctree& solid, const PhantomScanOptions& options,
                          Chance& chance);
inline constexpr double phantom_low = -1000.0;

}  // namespace octotomy::verify
