// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Adjacency of voxels: by a common face (6 neighbours; the thesis's 2-adjacency), a face or an edge (18;
/// 1-adjacency), or any corner (26; 0-adjacency).
enum class Neighbours { Faces = 6, Edges = 18, Corners = 26 };

/// The connected components, largest first. Components of equal size are in the order of their first voxels,
/// x fastest.
struct Components {
  std::vector<std::uint64_t> voxel_counts;
  Octree largest;
};
/// Memory, here and below: 20 bytes per run of voxels along x. The number of runs grows with the boundary's
/// area.
Components components(const Octree& octree, Neighbours neighbours = Neighbours::Faces);

/// The number of connected components. Does not build their octrees.
std::size_t component_count(const Octree& octree, Neighbours neighbours = Neighbours::Faces);

/// The union of the components that contain a seed. Seeds outside the object are ignored.
Octree components_at(const Octree& octree, const std::vector<glm::ivec3>& seeds,
                     Neighbours neighbours = Neighbours::Faces);

/// The union of the components that contain a voxel of another octree. Precondition: both have the same
/// universe.
Octree components_that_meet(const Octree& octree, const Octree& other,
                            Neighbours neighbours = Neighbours::Faces);

/// The union of the components of at least `voxel_count` voxels.
Octree components_of_at_least(const Octree& octree, std::uint64_t voxel_count,
                              Neighbours neighbours = Neighbours::Faces);

/// The union of the components that touch a face of the universe.
Octree components_at_faces(const Octree& octree, Neighbours neighbours = Neighbours::Faces);

}  // namespace octotomy::voxel
