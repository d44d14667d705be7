// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "verify/phantom/measured_solid.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {

struct PhantomScanOptions {
  double blur_voxels = 0.0;  ///< deviation of a Gaussian along each axis
  /// deviation of the noise, as a share of the contrast between inside and outside
  double noise_share = 0.0;
  /// The scan has only the slices that the solid meets and seven more at both ends. False: it has those of
  /// the whole universe.
  bool near_slices_only = false;
};

/// Scans a solid in the voxels of its universe. Samples are the filled shares of the voxels, blurred, with
/// noise, scaled from phantom_low (outside) to -phantom_low (inside). The half level is 0.
voxel::Scene phantom_scan(const voxel::PartialOctree& solid, const PhantomScanOptions& options,
                          Chance& chance);
inline constexpr double phantom_low = -1000.0;

}  // namespace octotomy::verify
