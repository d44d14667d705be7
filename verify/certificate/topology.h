// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "brep/mesh/solid.h"
#include "verify/certificate/certificate.h"
#include "voxel/tree/octree.h"

// Parts, cavities and tunnels of two sets of voxels, and the parts and cavities that only one set has.
namespace octotomy::verify {

struct Topology {
  std::int64_t parts = 0;     ///< components connected by faces, edges or corners
  std::int64_t cavities = 0;  ///< components of the outside that no path of faces connects with the border
  std::int64_t tunnels = 0;
};
Topology topology(const voxel::Octree& octree);

/// The parts (or cavities) of each set that share no voxel with a part (or cavity) of the other set. A part
/// without a block of three voxels a side does not count, because chance decides which voxels lie inside bone
/// thinner than a voxel.
struct Unmatched {
  std::uint64_t count = 0;
  /// The largest of the unmatched parts; its size is the longest side of its box.
  std::optional<WorstPlace> largest;
};
/// `voxels` is the voxel kernel's set, `mesh` the digitised mesh. Precondition: both have the same universe.
/// Cost: that of a few Booleans, and 20 bytes per run of voxels along x.
Unmatched unmatched_parts(const voxel::Octree& voxels, const voxel::Octree& mesh);
Unmatched unmatched_cavities(const voxel::Octree& voxels, const voxel::Octree& mesh);

/// Adds comparisons of parts, cavities and tunnels. An unmatched part or cavity is a FAIL; tunnels are
/// reported without a verdict. `digitised` are the voxels whose centre lies inside the mesh.
void compare_topology(Certificate& certificate, const voxel::Octree& octree, const voxel::Octree& digitised);

/// Adds comparisons of the Euler numbers and outer shells of an octree and of the isosurface of the same
/// samples. Both must be equal.
void compare_same_topology(Certificate& certificate, const voxel::Octree& octree, const brep::Solid& solid);

}  // namespace octotomy::verify
