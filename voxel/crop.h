// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/distance_map.h"
#include "voxel/progress.h"
#include "voxel/scene.h"

// Parts of a scene, and fewer samples of it (thesis 2.2.1: sub-regioning).
namespace octotomy::voxel {

/// The samples of a lattice whose centres lie in a box, bounds included, as the least range of indices that
/// holds them all; on a lattice that is turned it holds others too. Empty where there is none.
VoxelRange range_within(const Lattice& lattice, const Box& box);

/// The part of a scene that a range of indices is, where it was: positions in millimetres stay. Throws
/// std::invalid_argument where the range is empty or leaves the scene. Memory: the part.
Scene crop(const Scene& scene, const VoxelRange& range);

/// A sample for every block of factor.x x factor.y x factor.z: their mean, at the block's middle; integers
/// rounded to the nearest, halves upwards. At the far faces blocks may be cut off by the scene's end: they
/// are the means of what they have, at the place of a whole block. Throws std::invalid_argument where a
/// factor is less than 1, or the scene is a label map, of which there are no means; Stopped.
/// Parallel, same bits on any thread count.
Scene average_down(const Scene& scene, const glm::ivec3& factor, const Progress& progress = {});

}  // namespace octotomy::voxel
