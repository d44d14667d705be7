// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "voxel/codes/cuberille_faces.h"

namespace octotomy::voxel {

/// A face of an object's boundary: between a voxel of the object and the neighbour in `direction`, which is
/// not in the object.
struct SurfaceFace {
  glm::ivec3 voxel{0};
  Direction direction = Direction::PlusX;
  bool operator==(const SurfaceFace&) const = default;
};

/// The boundary's face nearest to a point in index space. Only faces whose middles lie within `most` voxels
/// of the point along each axis are compared; none if there are no such faces. Of equally near faces the
/// first by voxel, x fastest, then by direction, is returned.
std::optional<SurfaceFace> nearest_face(const Octree& octree, const glm::dvec3& p_voxel, double most);

/// ByFaces: voxels of the object are joined if they share a face. ByEdges: also if they share only an edge.
/// Voxels outside the object are joined by the opposite rule.
enum class Joined { ByFaces, ByEdges };

/// A connected part of an object's boundary.
struct TrackedSurface {
  CuberilleFaces faces;
  /// Number of voxels inside the surface, voxels in cavities included. The wall of a cavity encloses voxels
  /// outside the object; for it, this is minus the number of these voxels.
  std::int64_t enclosed_voxels = 0;
};

/// Tracks the surface from a seed face (thesis 2.3.2.1.2; Artzy, Frieder and Herman, Computer Graphics and
/// Image Processing 15, 1981). Every face lies on two circuits, about the two axes across its normal, and has
/// a successor on each; all faces that successors reach form the connected surface. Each face is reached
/// twice and is removed from memory the second time, so that only the front is stored. The result's lists are
/// sorted as CuberilleFaces requires. Throws std::invalid_argument if the seed is no face of the boundary.
/// Cost: a look-up of four voxels per face. Memory: the result and the front.
TrackedSurface track_surface(const Octree& octree, const SurfaceFace& seed, Joined joined = Joined::ByFaces);

}  // namespace octotomy::voxel
