// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/measure/distance_map.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Makes smaller scenes: a part of a scene, or a scene with fewer samples (thesis 2.2.1: sub-regioning).
namespace octotomy::voxel {

/// The smallest range of indices that contains every sample centre in a box, bounds included. On a rotated
/// lattice the range also contains centres outside the box. Empty if no centre lies in the box.
VoxelRange range_within(const Lattice& lattice, const Box& box);

/// The part of a scene in a range of indices; samples keep their positions in millimetres. Throws
/// std::invalid_argument if the range is empty or leaves the scene. Memory: the samples of the part.
Scene crop(const Scene& scene, const VoxelRange& range);

/// Replaces each block of factor.x x factor.y x factor.z samples by their mean, at the block's middle;
/// integers are rounded to the nearest, halves upwards. A block that the scene's end cuts off becomes the
/// mean of its remaining samples, but still lies at the middle of a whole block. A block that contains
/// padding becomes padding. Throws std::invalid_argument if a factor is less than 1 or the scene is a label
/// map, because labels have no mean; Stopped. Parallel, same bits on any thread count.
Scene average_down(const Scene& scene, const glm::ivec3& factor, const Progress& progress = {});

}  // namespace octotomy::voxel
