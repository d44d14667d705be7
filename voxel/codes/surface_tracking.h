// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "voxel/codes/cuberille_faces.h"

namespace octotomy::voxel {

/// A face of the boundary: between a voxel of the object and its neighbour in a direction, which is outside.
struct SurfaceFace {
  glm::ivec3 voxel{0};
  Direction direction = Direction::PlusX;
  bool operator==(const SurfaceFace&) const = default;
};

/// The boundary's face nearest to a point in voxels, whose integers are voxels' middles, among the faces whose
/// middles lie within `most` voxels along each axis; among equally near faces the first, by voxel, x fastest,
/// then by direction. None if no face is that near.
std::optional<SurfaceFace> nearest_face(const Octree& octree, const glm::dvec3& p_voxel, double most);

/// Whether voxels of the object that share only an edge are joined. Voxels outside are joined in the other
/// way.
enum class Joined { ByFaces, ByEdges };

/// A connected part of an object's boundary.
struct TrackedSurface {
  CuberilleFaces faces;
  /// Voxels inside the surface, those of cavities included; negative for the wall of a cavity, which encloses
  /// voxels outside the object.
  std::int64_t enclosed_voxels = 0;
};

/// Tracks the surface from a seed face (thesis 2.3.2.1.2; Artzy, Frieder and Herman, Computer Graphics and
/// Image Processing 15, 1981). Every face lies on two circuits, about the two axes across its normal, and has
/// a successor on each; the faces that are reached by successors are the connected surface. Each face is
/// reached twice and is forgotten the second time, so that only the front is kept. The result's lists are in
/// their usual order. Throws std::invalid_argument if the seed is no face of the boundary. Cost: a look-up of
/// four voxels per face. Memory: the result and the front.
TrackedSurface track_surface(const Octree& octree, const SurfaceFace& seed, Joined joined = Joined::ByFaces);

}  // namespace octotomy::voxel
