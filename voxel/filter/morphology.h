// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

// Morphology with a ball whose radius is in millimetres, exactly Euclidean for any spacing: the ball contains
// the voxels whose centres are at most the radius from the centre of its middle voxel. Voxels beyond the
// universe count as outside. Each function throws std::invalid_argument if the radius is negative or not
// finite, or the universe's axes are not perpendicular. Parallel; same bits on any thread count. Cost:
// distance maps over the object's range enlarged by the radius.

/// The voxels at most radius_mm from a voxel of the octree; the universe's faces cut the result off.
Octree dilate(const Octree& octree, double radius_mm);
/// The voxels farther than radius_mm from every voxel outside the octree.
Octree erode(const Octree& octree, double radius_mm);
/// Erosion, then dilation: all voxels that are covered by some ball inside the octree. A subset of the
/// octree.
Octree open(const Octree& octree, double radius_mm);
/// Dilation, then erosion: all voxels that no ball outside the octree covers. A superset of the octree. Exact
/// at the universe's faces too, because the dilation may leave the universe. Throws Error (Resource) if its
/// distance map does not fit into free_memory().
Octree close(const Octree& octree, double radius_mm);

/// The octree with its cavities filled. A cavity is a part of the background that no path of face neighbours
/// connects with the universe's border.
Octree fill_cavities(const Octree& octree);

}  // namespace octotomy::voxel
