// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxel/octree.h"
#include "voxel/progress.h"
#include "voxel/scene.h"

// Scenes whose samples are numbers of objects: 0 is none.
namespace octotomy::voxel {

/// The universe whose first voxels are the lattice's samples, at their very places and spacing: the smallest
/// that holds them. Throws std::length_error where it would take more than 2^Universe::max_depth a side.
Universe universe_on(const Lattice& lattice);

/// The label map of objects on a lattice: a sample is i + 1 where its position lies in a voxel of objects[i],
/// and in no earlier object. `overlaps` counts samples that lie in several. Throws std::invalid_argument
/// where there are more than 32767 objects. Parallel over slices.
struct LabelMap {
  Scene scene;
  std::uint64_t overlaps = 0;
};
LabelMap label_map(const Lattice& lattice, std::span<const Octree> objects, const Progress& progress = {});

/// The labels that occur, but for 0, ascending, and how many samples have each. Throws std::invalid_argument
/// where a sample is no integer or negative.
struct Label {
  int number = 0;
  std::uint64_t samples = 0;
};
std::vector<Label> labels(const Scene& scene);

/// The voxels of a universe whose centre is nearest to a sample of that label; voxels beyond the scan are
/// empty. Parallel over blocks.
Octree octree_of_label(const Universe& universe, const Scene& scene, int label);

}  // namespace octotomy::voxel
