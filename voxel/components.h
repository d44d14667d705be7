// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/octree.h"

namespace octotomy::voxel {

/// Which voxels touch: those that share a face (6 neighbours; the thesis's 2-adjacency), a face or an edge
/// (18; 1-adjacency), or any corner (26; 0-adjacency).
enum class Neighbours { Faces = 6, Edges = 18, Corners = 26 };

/// Parts that touch, largest first; equal sizes in the order of their first voxel, x fastest.
struct Components {
  std::vector<std::uint64_t> voxel_counts;
  Octree largest;
};
/// Memory, here and below: 20 bytes per run of voxels along x, which follows the boundary, not the volume.
Components components(const Octree& octree, Neighbours neighbours = Neighbours::Faces);

/// The parts that hold any of the seeds; seeds that are not in the octree choose none.
Octree components_at(const Octree& octree, const std::vector<glm::ivec3>& seeds,
                     Neighbours neighbours = Neighbours::Faces);

/// The parts of at least so many voxels.
Octree components_of_at_least(const Octree& octree, std::uint64_t voxel_count,
                              Neighbours neighbours = Neighbours::Faces);

/// The parts that reach a face of the universe.
Octree components_at_faces(const Octree& octree, Neighbours neighbours = Neighbours::Faces);

}  // namespace octotomy::voxel
