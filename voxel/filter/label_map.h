// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"
#include "voxel/tree/octree.h"

// Scenes whose samples are the numbers of objects; 0 means no object.
namespace octotomy::voxel {

/// The smallest universe whose first voxels are the lattice's samples, in position and spacing. Throws
/// std::length_error if it needs more than 2^Universe::max_depth voxels a side.
Universe universe_on(const Lattice& lattice);

/// The label map of objects on a lattice: a sample is i + 1 if objects[i] is the first object with a voxel at
/// its position. `overlaps` counts the samples in several objects. Throws std::invalid_argument for more than
/// 32767 objects; Stopped. Parallel over slices.
struct LabelMap {
  Scene scene;
  std::uint64_t overlaps = 0;
};
LabelMap label_map(const Lattice& lattice, std::span<const Octree> objects, const Progress& progress = {});

/// The labels of a scene except 0, ascending, with their numbers of samples. Throws std::invalid_argument if
/// a sample is negative or no integer.
struct Label {
  int number = 0;
  std::uint64_t samples = 0;
};
std::vector<Label> labels(const Scene& scene);

/// The voxels of a universe whose nearest sample has that label; voxels beyond the scan are empty. Parallel
/// over blocks.
Octree octree_of_label(const Universe& universe, const Scene& scene, int label);

}  // namespace octotomy::voxel
