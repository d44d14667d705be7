// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "verify/certificate.h"
#include "verify/reading.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// The order of voxels by z, then y, then x.
bool before(const glm::ivec3& a, const glm::ivec3& b);

/// Voxels that touch by faces, edges or corners, as indices. Precondition: the voxels are in the order of
/// before(), each once. Cost: order n log n.
std::vector<std::vector<std::size_t>> groups_of(const std::vector<glm::ivec3>& voxels);

/// Finds by which necks parts of one answer alone hang on, in an object or in what it was made of. Keeps a
/// reference to the octree.
class Bridges {
 public:
  Bridges(const voxel::Octree& octree, const voxel::Octree& digitised, const Witness& witness);

  /// Takes the parts that hang on by a thin neck (Necks::neck_mm()) from voxels that one answer alone has,
  /// and returns a place for each. Precondition: the voxels are in the order of before(), each once.
  std::vector<WorstPlace> take_from(std::vector<glm::ivec3>& voxels) const;

 private:
  const voxel::Octree& octree_;
  std::vector<PartChoice> choices_;
};

}  // namespace octotomy::verify
