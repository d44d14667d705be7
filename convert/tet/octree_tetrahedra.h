// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "convert/tet/tetrahedra.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::convert {

/// The size of elements at the boundary: that of the octree's nodes, or one voxel. With Voxels, anything else
/// that ends at the boundary ends at corners of elements.
enum class BoundaryCells { Nodes, Voxels };

/// Tetrahedra, in LPS millimetres, that fill the voxels of an octree exactly: its Full nodes, divided until
/// neighbours differ by one level at most, each cut from its middle. Always succeeds. Elements are large
/// inside and voxel-sized at the boundary, which keeps the voxels' steps: displacements and stiffness are
/// useful, stresses at the surface are not. Conforming: elements share whole faces; parts that touch share
/// nodes. With cubic voxels every dihedral angle is at least 30 degrees. `method` is "octree". Throws
/// std::invalid_argument if the octree is empty; voxel::Error (Resource) if there are more nodes than 32-bit
/// numbers can name, or the elements do not fit into voxel::free_memory(), with both figures; voxel::Stopped.
/// Deterministic. Cost: for each voxel at the boundary about 12 elements, 300 bytes of the result and 10
/// bytes of working memory; also 9 bytes for every 16 x 16 x 16 voxels of the universe.
Tetrahedra tetrahedra_of(const voxel::Octree& octree, BoundaryCells boundary = BoundaryCells::Nodes,
                         const voxel::Progress& progress = {});

/// Fills several regions of one universe. Elements of touching regions have the same corners on the
/// interface, and none reaches into two regions. A voxel in several regions belongs to the first.
/// `region_of_tet` numbers regions in the order given. Cells at interfaces count as boundary cells;
/// `boundary_nodes` are only those on the outside of all regions. Throws std::invalid_argument also if there
/// is no region or their universes differ.
Tetrahedra tetrahedra_of(const std::vector<voxel::Octree>& regions,
                         BoundaryCells boundary = BoundaryCells::Nodes, const voxel::Progress& progress = {});

}  // namespace octotomy::convert
