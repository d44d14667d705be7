// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/lattice.h"

namespace octotomy::tests {

/// The cut of the Le Fort I plan through the head phantom: maxilla with the upper teeth and the lower
/// zygomas. Its planes lie on faces of voxels of half a millimetre.
inline const voxel::Box le_fort_cut{{-40, -90, -60}, {40, -20, -25}};

}  // namespace octotomy::tests
