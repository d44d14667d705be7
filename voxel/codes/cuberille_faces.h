// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// The six directions of a voxel's faces, in the order of the thesis's six lists.
enum class Direction : std::uint8_t { PlusX, MinusX, PlusY, MinusY, PlusZ, MinusZ };
inline constexpr int direction_count = 6;

/// The unit step along a direction in index space.
glm::ivec3 step(Direction direction);
/// "x+", "z-".
std::string name_of(Direction direction);

/// The cuberille (thesis 3.1.2.2): for each of the six directions, a list of the object's voxels whose
/// neighbour in that direction is outside the object or the universe. Each list is in ascending order, x
/// fastest, then y, z.
struct CuberilleFaces {
  Universe universe;
  std::array<std::vector<glm::ivec3>, direction_count> lists;

  std::size_t face_count() const;
};

/// All exposed faces of an object, those of cavities included. Cost: voxel_boundary() and a sort of its
/// faces. Memory: 32 bytes per face.
CuberilleFaces cuberille_faces(const Octree& octree);
/// The object that the faces bound. Throws std::invalid_argument with the first face that lies outside the
/// universe, is out of order, or contradicts the other faces.
Octree octree_of(const CuberilleFaces& faces);

/// One line per direction: `x+ (1,2,0), (1,3,0), ...`.
std::string text(const CuberilleFaces& faces);
/// The inverse of text(). Throws std::invalid_argument with the position of the wrong character; octree_of()
/// checks the faces. Memory: in proportion to the text.
CuberilleFaces parse_cuberille_faces(const Universe& universe, std::string_view text);

}  // namespace octotomy::voxel
