// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <vector>

#include "convert/tet/sizing_field.h"
#include "convert/tet/tetrahedra.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::convert {

struct RegionMeshOptions {
  double size_mm = 2.0;                          ///< target size of elements; below two voxels, the voxels'
                                                 ///< steps show
  std::vector<Refinement> finer{};               ///< places of smaller elements
  double min_dihedral_deg = 8.0;                 ///< goal, 0..30
  std::chrono::milliseconds time_limit{300000};  ///< processor time
  std::uint64_t memory_limit_bytes = 4ull << 30;
  voxel::Progress progress{};  ///< reports the share of the time limit that is used up
};

/// Quality tetrahedra, in LPS millimetres, of several regions of one universe with smooth surfaces. Touching
/// regions share the nodes of their interface. CGAL's Mesh_3 fills the image of the regions' labels in a
/// separate process. Two regions meet where their trilinear shares are equal: half-way between voxels, and
/// smooth across their steps. Two regions whose interface is flat within the voxels' resolution meet in its
/// plane; a finding reports nodes that stay off it. A voxel in several regions belongs to the first.
/// `region_of_tet` numbers regions in the order given. `boundary_nodes` are only those on the outside of all
/// regions. Nodes move to improve flat elements, on surfaces by a tenth of the size at most.
///
/// Guaranteed: all volumes positive; each region's volume differs from its voxels' volume by at most a
/// quarter of a voxel times its surface; `findings` has both. Deterministic. Memory: a byte a voxel of the
/// regions' box, and the mesher's. Throws std::invalid_argument if there is no region or more than 255, if
/// one is empty, if universes differ or an option is out of range; voxel::Error (Geometry) if the mesher
/// fails, or loses a region with parts thinner than the size: tetrahedra_of() (octree_tetrahedra.h) always
/// keeps them; voxel::Error (Resource) at a limit; voxel::Stopped.
Tetrahedra smooth_tetrahedra_of(const std::vector<voxel::Octree>& regions,
                                const RegionMeshOptions& options = {});

}  // namespace octotomy::convert
