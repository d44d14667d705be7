// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/lattice.h"

namespace octotomy::voxel {

/// For each axis, the ratio of Measures::area_crofton13_mm2 to the true area for a flat boundary with its
/// normal along this lattice axis: 0.92 to 0.93 for cubic voxels, less for elongated voxels.
glm::dvec3 crofton13_of_flat(const Lattice& lattice);

}  // namespace octotomy::voxel
