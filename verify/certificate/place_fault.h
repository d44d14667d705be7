// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "brep/mesh/triangles.h"
#include "verify/witness/reading.h"
#include "voxel/tree/octree.h"

// The kinds of faults at a voxel, and the choice of sampled voxels. Both places.cpp and place_limit.cpp judge
// by them.
namespace octotomy::verify {

/// The fault at a voxel. Apart: the kernels differ and the witness does not decide. Lost: resampling lost or
/// filled a part that the mesh rightly has or lacks, which is not an error.
enum class PlaceFault : std::uint8_t { None, VoxelsLack, VoxelsHave, MeshLacks, MeshHas, Apart, Lost };

PlaceFault fault_of(const Reading& reading, bool in_voxels, bool in_mesh);

/// Where a connection is thinner than a voxel, as in thin bone, chance decides whether a kernel keeps the
/// part beyond. So a group of Apart voxels is no fault if it has fewer voxels than a block of three a side,
/// and shares no face with voxels of the kernel that lacks the group.
inline constexpr std::size_t chance_voxels = 27;

inline bool is_within(const glm::ivec3& voxel, const voxel::Octree& octree) {
  return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
         glm::all(glm::lessThan(voxel, glm::ivec3(octree.universe().side())));
}

/// Away from surfaces the witness is read at one voxel in eight: one in each block of two voxels a side.
inline constexpr int sampled_one_in = 8;
constexpr bool is_sampled(int x, int y, int z) {
  return ((x + 2 * y + 4 * z) & (sampled_one_in - 1)) == 0;
}
inline bool is_sampled(const glm::ivec3& voxel) {
  return is_sampled(voxel.x, voxel.y, voxel.z);
}
/// The sampled voxel of the block of two voxels a side whose lowest voxel is `first`.
inline glm::ivec3 sampled_in_block(const glm::ivec3& first) {
  glm::ivec3 at = first;
  for (int i = 0; i < 8 && !is_sampled(at); ++i)
    at = first + glm::ivec3((i + 1) & 1, ((i + 1) >> 1) & 1, (i + 1) >> 2);
  return at;
}

struct CentredFace {
  glm::dvec3 centroid_mm{0.0};
  double area_mm2 = 0.0;
};
inline CentredFace centred_face(const brep::Triangles& mesh, std::size_t face) {
  const auto& [a, b, c] = mesh.faces[face];
  const glm::dvec3 &p = mesh.points_mm[a], &q = mesh.points_mm[b], &r = mesh.points_mm[c];
  return {(p + q + r) / 3.0, 0.5 * glm::length(glm::cross(q - p, r - p))};
}

}  // namespace octotomy::verify
