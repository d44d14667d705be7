// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/lattice.h"

namespace octotomy::voxel {

/// The share of the area of a plane along the lattice that Measures::area_crofton13_mm2 finds, by the axis of
/// its normal: 0.92 to 0.93 for cubes, less for longer voxels.
glm::dvec3 crofton13_of_flat(const Lattice& lattice);

}  // namespace octotomy::voxel
