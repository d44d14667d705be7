// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/octree.h"

namespace octotomy::voxel {

// Morphology with a ball of a radius in millimetres, exactly Euclidean on the lattice, whatever its spacing:
// a voxel belongs to the ball where its centre is at most the radius from the ball's. Voxels beyond the
// universe are outside. Preconditions: a radius that is not negative and finite, axes of the universe at
// right angles; each throws std::invalid_argument where that fails. Parallel; same bits on any thread count.
// Cost: that of distance maps over the object's range and the radius around it.

/// Voxels at most radius_mm from one of the octree; cut off at the universe's faces.
Octree dilate(const Octree& octree, double radius_mm);
/// Voxels farther than radius_mm from every voxel outside the octree.
Octree erode(const Octree& octree, double radius_mm);
/// Erosion, then dilation: what a ball that stays inside reaches. Within the octree.
Octree open(const Octree& octree, double radius_mm);
/// Dilation, then erosion: what a ball that stays outside does not reach. Holds the octree; not cut short at
/// the universe's faces, as the dilation may leave it.
Octree close(const Octree& octree, double radius_mm);

/// The octree with its cavities: parts of the outside that no path of face neighbours joins to the outside of
/// the universe.
Octree fill_cavities(const Octree& octree);

}  // namespace octotomy::voxel
