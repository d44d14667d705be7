// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "brep/mesh/solid.h"
#include "verify/certificate/certificate.h"
#include "voxel/tree/octree.h"

// How two sets of voxels hang together, and what one of them lacks altogether.
namespace octotomy::verify {

struct Topology {
  std::int64_t parts = 0;     ///< connected by faces, edges or corners
  std::int64_t cavities = 0;  ///< that no path of faces connects with the universe's border
  std::int64_t tunnels = 0;
};
Topology topology(const voxel::Octree& octree);

/// The parts, or cavities, of either set that share no voxel with one of the other's. A part that holds no
/// block of three voxels a side may be chance, as bone thinner than a voxel is, and does not count.
struct Unmatched {
  std::uint64_t count = 0;
  /// The largest of them; its size is its box's longest side. The first set is the voxels', the other the
  /// mesh's.
  std::optional<WorstPlace> largest;
};
/// Both sets have the same universe. Cost: that of a few Booleans, and 20 bytes per run of voxels along x.
Unmatched unmatched_parts(const voxel::Octree& voxels, const voxel::Octree& mesh);
Unmatched unmatched_cavities(const voxel::Octree& voxels, const voxel::Octree& mesh);

/// Adds both sets' parts and cavities, of which neither kernel may lose or add one that counts as unmatched,
/// and their tunnels, which are told. `digitised` are the voxels whose centre lies inside of the mesh.
void compare_topology(Certificate& certificate, const voxel::Octree& octree, const voxel::Octree& digitised);

/// Adds the Euler numbers and outer shells of an octree and of the surface of its own samples: equal ones.
void compare_same_topology(Certificate& certificate, const voxel::Octree& octree, const brep::Solid& solid);

}  // namespace octotomy::verify
