// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Source: Artzy, Frieder and Herman 1981 (thesis 2.3.2.1.2). Walking round an axis in the positive sense, a
// face has one next face across the edge it comes to: of four voxels about that edge the face's own is in the
// object and the one across it is not, and the other two decide. A face takes part in the walks round the two
// axes that it is parallel to, so it has two next faces and is the next of two: in such a directed graph
// whatever is connected can be reached from any of its faces, and walking one sense only loses nothing.
#include "voxel/boundary_track.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <unordered_set>

namespace octotomy::voxel {
namespace {

// Faces by number: six times the voxel's, which is below 2^36.
std::uint64_t key_of(const Face& face, int depth) {
  const auto voxel = (static_cast<std::uint64_t>(face.voxel.z) << (2 * depth)) |
                     (static_cast<std::uint64_t>(face.voxel.y) << depth) |
                     static_cast<std::uint64_t>(face.voxel.x);
  return voxel * direction_count + static_cast<std::uint64_t>(face.direction);
}

// The direction that `from` turns to by a quarter round an axis, counter-clockwise seen from its tip.
Direction turned(Direction from, int axis) {
  glm::ivec3 round(0);
  round[axis] = 1;
  const glm::ivec3 n = step(from);
  const glm::ivec3 to(round.y * n.z - round.z * n.y, round.z * n.x - round.x * n.z,
                      round.x * n.y - round.y * n.x);
  const int along = to.x != 0 ? 0 : to.y != 0 ? 1 : 2;
  return static_cast<Direction>(2 * along + (to[along] > 0 ? 0 : 1));
}

Face next_face(const Octree& octree, const Face& face, int axis) {
  const Direction ahead = turned(face.direction, axis);
  const glm::ivec3 beside = face.voxel + step(ahead);
  const glm::ivec3 across = beside + step(face.direction);
  // The object is 1-connected: it goes on through the edge, whether or not the voxel beside belongs to it.
  if (octree.contains(across)) return {across, opposite(ahead)};
  if (octree.contains(beside)) return {beside, face.direction};
  return {face.voxel, ahead};
}

}  // namespace

bool is_boundary(const Octree& octree, const Face& face) {
  return octree.contains(face.voxel) && !octree.contains(face.voxel + step(face.direction));
}

CuberilleFaces track_boundary(const Octree& octree, const Face& seed) {
  if (!is_boundary(octree, seed))
    throw std::invalid_argument("the seed face of voxel (" + std::to_string(seed.voxel.x) + "," +
                                std::to_string(seed.voxel.y) + "," + std::to_string(seed.voxel.z) +
                                ") is not exposed: choose a voxel of the object whose neighbour is not");
  const int depth = octree.universe().depth;
  std::unordered_set<std::uint64_t> met{key_of(seed, depth)};
  std::vector<Face> open{seed};
  CuberilleFaces faces{octree.universe(), {}};
  while (!open.empty()) {
    const Face face = open.back();
    open.pop_back();
    faces.lists[static_cast<std::size_t>(face.direction)].push_back(face.voxel);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == static_cast<int>(face.direction) / 2) continue;
      const Face next = next_face(octree, face, axis);
      if (met.insert(key_of(next, depth)).second) open.push_back(next);
    }
  }
  for (auto& list : faces.lists)
    std::sort(list.begin(), list.end(), [](const glm::ivec3& a, const glm::ivec3& b) {
      return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
    });
  return faces;
}

}  // namespace octotomy::voxel
