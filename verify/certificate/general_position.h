// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "brep/mesh/solid.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// One set of voxels in both kernels.
struct ExactOperand {
  voxel::Octree octree;  ///< on the refined lattice
  brep::Solid solid;     ///< its cuberille
};

/// Sets of voxels whose surfaces meet only by crossing.
struct GeneralPosition {
  /// Unit voxels: refined voxel q reaches from q to q + 1 millimetres, so all coordinates are integers.
  voxel::Universe universe;
  int refinement = 1;  ///< refined voxels along an edge of an original voxel
  std::vector<ExactOperand> operands;
};

/// Brings sets of voxels of one universe into general position, so that every Boolean of the sets has a
/// manifold surface without coinciding faces. Each set is refined. It loses a quarter of a voxel all round,
/// which separates voxels that only touched at edges or corners. It shifts by its own number of refined
/// voxels along (-1,-1,-1). So no plane of one set is a plane of another set or of the universe's border. The
/// sets differ a little from the input, but both kernels get the same sets. Throws std::invalid_argument if
/// there is no set or the universes differ; voxel::Error (Resource) if the refined universe would be too
/// large; voxel::Stopped. Cost: a lattice refined by twice the least power of two above the number of sets;
/// eight times as many triangles as a cuberille has faces.
GeneralPosition general_position(const std::vector<voxel::Octree>& sets,
                                 const voxel::Progress& progress = {});

}  // namespace octotomy::verify
