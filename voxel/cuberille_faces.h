// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/octree.h"

namespace octotomy::voxel {

/// The six directions of a voxel's faces, in the order of the thesis's six lists.
enum class Direction : std::uint8_t { PlusX, MinusX, PlusY, MinusY, PlusZ, MinusZ };
inline constexpr int direction_count = 6;

/// The unit step along a direction in index space.
glm::ivec3 step(Direction direction);
Direction opposite(Direction direction);

/// A face of a voxel of the object, seen from outside along `direction`.
struct Face {
  glm::ivec3 voxel{0};
  Direction direction = Direction::PlusX;
  bool operator==(const Face&) const = default;
};

/// The cuberille (thesis 3.1.2.2): six lists, one a direction, of the voxels whose face there borders a voxel
/// that is not in the object, or the universe's end. Each list is in ascending order, x fastest, then y, z.
struct CuberilleFaces {
  Universe universe;
  std::array<std::vector<glm::ivec3>, direction_count> lists;

  std::size_t face_count() const;
};

/// All exposed faces, inner boundaries included. Cost: the slices that hold a voxel, side^2 / 8 bytes each;
/// 12 bytes a face.
CuberilleFaces cuberille_faces(const Octree& octree);
/// The object that the faces bound. Throws std::invalid_argument naming the face that lies outside the
/// universe, out of order, or is not where the others put the boundary.
Octree octree_of(const CuberilleFaces& faces);

/// A line a direction: `x+ (1,2,0), (1,3,0), ...`.
std::string text(const CuberilleFaces& faces);
/// The inverse. Throws std::invalid_argument with the position of the character; faces are checked by
/// octree_of(). Memory: in proportion to the text.
CuberilleFaces parse_cuberille_faces(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
