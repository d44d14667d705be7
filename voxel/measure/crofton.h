// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/lattice.h"

namespace octotomy::voxel {

/// Ratio of Measures::area_crofton13_mm2 to the true area of a flat boundary along the lattice, by the axis
/// of its normal: 0.92 to 0.93 for cubic voxels, less for longer ones.
glm::dvec3 crofton13_of_flat(const Lattice& lattice);

}  // namespace octotomy::voxel
