// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "brep/mesh.h"
#include "voxel/octree.h"

namespace octotomy::verify {

/// A set of voxels as both kernels hold it: the same set, exactly.
struct ExactOperand {
  voxel::Octree octree;                     ///< on the refined lattice
  std::shared_ptr<const brep::Mesh> solid;  ///< its cuberille
};

/// Sets of voxels whose surfaces meet nowhere but across each other.
struct GeneralPosition {
  /// Unit voxels, refined voxel q reaching from q to q + 1 millimetre: all coordinates are whole.
  voxel::Universe universe;
  int refinement = 1;  ///< refined voxels along an edge of one of the sets' own
  std::vector<ExactOperand> operands;
};

/// Brings sets of voxels of one universe into general position, so that any Boolean of them has a manifold
/// surface in which no two faces coincide. Each set is refined and loses a quarter of a voxel all round
/// (which parts what only touched), and is shifted by a number of refined voxels of its own along (-1,-1,-1):
/// no plane of one set is a plane of another, nor of the universe's border. The sets are no longer those that
/// came in, but they are of the same shape, and both kernels get the same. Throws std::invalid_argument where
/// there is no set or the universes differ, std::length_error where the refined universe would be larger than
/// any may be. Cost: a refined lattice of twice as many voxels a side as there are sets, by powers of two;
/// eight times as many triangles as a cuberille has faces.
GeneralPosition general_position(const std::vector<voxel::Octree>& sets);

}  // namespace octotomy::verify
