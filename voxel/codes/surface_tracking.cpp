// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A face between voxel p, inside, and p + n, outside, continues across one of its edges, in the direction a,
// by one of three faces. The voxels p + a and p + a + n decide:
//
//     p + n   p + a + n        p + a outside:                     the face of p towards a
//     p       p + a            p + a inside, p + a + n outside:   the face of p + a towards n
//                              both inside:                       the face of p + a + n against a
//
// If p + a is outside and p + a + n is inside, p and p + a + n share only this edge. Joined by edges, the
// surface goes on over p + a + n; joined by faces, it stays on p.
#include "voxel/codes/surface_tracking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <unordered_map>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

class Tracker {
 public:
  Tracker(const Octree& octree, Joined joined)
      : octree_(octree), side_(octree.universe().side()), joined_(joined) {}

  bool is_inside(const glm::ivec3& voxel) const {
    return glm::all(glm::greaterThanEqual(voxel, glm::ivec3(0))) &&
           glm::all(glm::lessThan(voxel, glm::ivec3(side_))) && octree_.contains(voxel);
  }
  bool is_boundary(const SurfaceFace& face) const {
    return is_inside(face.voxel) && !is_inside(face.voxel + step(face.direction));
  }

  /// The next face on the circuit around an axis, counter-clockwise as seen from the axis's positive end.
  SurfaceFace successor(const SurfaceFace& face, int axis) const {
    const glm::ivec3 n = step(face.direction);
    glm::ivec3 about(0);
    about[axis] = 1;
    const glm::ivec3 a(about.y * n.z - about.z * n.y, about.z * n.x - about.x * n.z,
                       about.x * n.y - about.y * n.x);
    const bool is_ahead = is_inside(face.voxel + a), is_above = is_inside(face.voxel + a + n);
    if (is_above && (is_ahead || joined_ == Joined::ByEdges)) return {face.voxel + a + n, along(-a)};
    if (is_ahead) return {face.voxel + a, face.direction};
    return {face.voxel, along(a)};
  }

  std::uint64_t key(const SurfaceFace& face) const {
    const auto side = static_cast<std::uint64_t>(side_);
    const auto at =
        static_cast<std::uint64_t>(face.voxel.x) +
        side * (static_cast<std::uint64_t>(face.voxel.y) + side * static_cast<std::uint64_t>(face.voxel.z));
    return 6 * at + static_cast<std::uint64_t>(face.direction);
  }

 private:
  static Direction along(const glm::ivec3& unit) {
    const int axis = unit.x != 0 ? 0 : unit.y != 0 ? 1 : 2;
    return static_cast<Direction>(2 * axis + (unit[axis] < 0 ? 1 : 0));
  }

  const Octree& octree_;
  int side_;
  Joined joined_;
};

std::tuple<int, int, int> x_fastest(const glm::ivec3& voxel) {
  return {voxel.z, voxel.y, voxel.x};
}

/// The distance of a point from a face, which is a square with edges of length 1; in voxels.
double distance_to(const SurfaceFace& face, const glm::dvec3& p) {
  const glm::ivec3 n = step(face.direction);
  const glm::dvec3 middle = glm::dvec3(face.voxel) + 0.5 * glm::dvec3(n);
  glm::dvec3 off = glm::abs(p - middle);
  for (int axis = 0; axis < 3; ++axis)
    if (n[axis] == 0) off[axis] = std::max(0.0, off[axis] - 0.5);
  return glm::length(off);
}

}  // namespace

std::optional<SurfaceFace> nearest_face(const Octree& octree, const glm::dvec3& p_voxel, double most) {
  const Tracker tracker(octree, Joined::ByFaces);
  const int side = octree.universe().side();
  const glm::ivec3 low =
      glm::max(glm::ivec3(glm::ceil(glm::clamp(p_voxel - most - 0.5, -1.0, side + 1.0))), 0);
  const glm::ivec3 high =
      glm::min(glm::ivec3(glm::floor(glm::clamp(p_voxel + most + 0.5, -1.0, side + 1.0))), side - 1);
  std::optional<SurfaceFace> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        for (int direction = 0; direction < direction_count; ++direction) {
          const SurfaceFace face{{x, y, z}, static_cast<Direction>(direction)};
          const glm::dvec3 middle = glm::dvec3(face.voxel) + 0.5 * glm::dvec3(step(face.direction));
          if (glm::any(glm::greaterThan(glm::abs(p_voxel - middle), glm::dvec3(most)))) continue;
          const double distance = distance_to(face, p_voxel);
          if (distance >= least || !tracker.is_boundary(face)) continue;
          least = distance;
          nearest = face;
        }
  return nearest;
}

TrackedSurface track_surface(const Octree& octree, const SurfaceFace& seed, Joined joined) {
  const Tracker tracker(octree, joined);
  if (!tracker.is_boundary(seed))
    throw InvalidInput("the tracking of a surface must begin at a face of the boundary: voxel " +
                       std::to_string(seed.voxel.x) + " " + std::to_string(seed.voxel.y) + " " +
                       std::to_string(seed.voxel.z) + " has none in that direction");
  TrackedSurface made{{octree.universe(), {}}, 0};
  std::vector<SurfaceFace> waiting{seed};
  // For each face of the front, the number of times that it will still be reached.
  std::unordered_map<std::uint64_t, int> front{{tracker.key(seed), 2}};
  while (!waiting.empty()) {
    const SurfaceFace face = waiting.back();
    waiting.pop_back();
    made.faces.lists[static_cast<std::size_t>(face.direction)].push_back(face.voxel);
    if (face.direction == Direction::PlusX) made.enclosed_voxels += face.voxel.x + 1;
    if (face.direction == Direction::MinusX) made.enclosed_voxels -= face.voxel.x;
    const int normal = static_cast<int>(face.direction) / 2;
    for (const int about : {(normal + 1) % 3, (normal + 2) % 3}) {
      const SurfaceFace next = tracker.successor(face, about);
      const auto [at, is_new] = front.try_emplace(tracker.key(next), 1);
      if (is_new)
        waiting.push_back(next);
      else if (--at->second == 0)
        front.erase(at);
    }
  }
  for (auto& list : made.faces.lists)
    std::sort(list.begin(), list.end(),
              [](const glm::ivec3& a, const glm::ivec3& b) { return x_fastest(a) < x_fastest(b); });
  return made;
}

}  // namespace octotomy::voxel
