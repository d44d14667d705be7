// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/solid/expression.h"
#include "voxel/space/scene.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

// The subjects of benchmarks: objects that fill a universe in the same way at every size, so that sizes can
// be compared.

namespace octotomy::bench {

/// A universe of `side` voxels a side around the head phantom.
voxel::Universe universe(int side);

/// A ball whose radius is a quarter of the universe's side, off its middle by a share of the side along x.
voxel::Expression sphere(int side, double offset);
/// The ball cut by a chequerboard of cells of an eighth of the side (thesis 3.3.3).
voxel::Octree chequered_sphere(int side);

/// The head phantom scanned on the universe's own lattice, computed once for each side.
const voxel::Scene& head(int side);
/// The bone of the head phantom: the window from 300 HU.
voxel::Octree skull(int side);
voxel::GreyOctree grey_skull(int side);
/// A box about the face, and an oblique cut through the skull.
voxel::Expression face_box(int side);
voxel::Expression oblique_half_space(int side);

}  // namespace octotomy::bench
