// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "convert/tetrahedra.h"
#include "voxel/octree.h"
#include "voxel/progress.h"

namespace octotomy::convert {

/// How large elements at the boundary may be: as the octree's nodes are, or a voxel each, so that whatever
/// else ends at the boundary ends at corners of elements.
enum class BoundaryCells { Nodes, Voxels };

/// Tetrahedra that fill the voxels of an octree exactly: its Full nodes, divided until neighbours differ by
/// one level at most, each cut from its middle. Always succeeds; large elements within, voxel-sized ones at
/// the boundary, which stays in steps: displacements and stiffness are useful, stresses at the surface are
/// not. Conforming: elements share whole faces, and those of parts that touch share nodes. Every dihedral
/// angle is at least 30 degrees where voxels are cubes. `method` says "octree". In LPS millimetres. Throws
/// std::invalid_argument where the octree is empty, std::length_error where 32 bits do not number the nodes.
/// Deterministic. Cost: about 12 elements and 300 bytes an element of memory a voxel at the boundary.
/// Throws voxel::Stopped where `progress` asks for it.
Tetrahedra tetrahedra_of(const voxel::Octree& octree, BoundaryCells boundary = BoundaryCells::Nodes,
                         const voxel::Progress& progress = {});

/// The same of several regions of one universe, which share the nodes of their interfaces: elements of
/// touching regions have the same corners there, and none reaches into two regions. A voxel in several
/// belongs to the first; `region_of_tet` numbers them in the order given. Boundary cells are those at
/// interfaces, too; boundary nodes are those of the outside alone. Throws std::invalid_argument where there
/// is no region, one is empty, or their universes differ.
Tetrahedra tetrahedra_of(const std::vector<voxel::Octree>& regions,
                         BoundaryCells boundary = BoundaryCells::Nodes, const voxel::Progress& progress = {});

}  // namespace octotomy::convert
