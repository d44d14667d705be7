// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/object_normals.h"

#include <cassert>
#include <tbb/parallel_for.h>

#include "voxel/view/pixel_index.h"

namespace octotomy::voxel {
namespace {

glm::ivec3 unit(int axis, int sign) {
  glm::ivec3 step(0);
  step[axis] = sign;
  return step;
}

/// How the surface continues beyond a side of the face: 1 if it rises, 0 if it is level, -1 if it falls.
int turn(const Octree& octree, const glm::ivec3& voxel, const glm::ivec3& outward, const glm::ivec3& side) {
  if (octree.contains(voxel + side + outward)) return 1;
  return octree.contains(voxel + side) ? 0 : -1;
}

/// The voxel of the object that a ray meets at a depth, and the axis of the face through which the ray
/// enters.
struct Face {
  glm::ivec3 voxel{0};
  int axis = 0;
  int outward = 1;
};
Face face_at(const Octree& octree, const glm::dvec3& p_voxel, const glm::dvec3& per_mm) {
  // The depth of a face is rounded to float; an interpolated depth lies up to two voxels in front of the
  // voxel.
  const glm::dvec3 direction = glm::normalize(per_mm);
  constexpr double step_voxels = 1.0 / 64.0;
  glm::ivec3 before = glm::ivec3(glm::floor(p_voxel - step_voxels * direction + 0.5));
  Face face;
  for (int step = 0; step <= 3 * 64; ++step) {
    const glm::ivec3 here = glm::ivec3(glm::floor(p_voxel + step * step_voxels * direction + 0.5));
    if (octree.contains(here)) {
      face.voxel = here;
      // If the ray enters through an edge or corner, the axis nearest to the ray's direction is chosen.
      double most = -1.0;
      for (int axis = 0; axis < 3; ++axis) {
        const double along = std::abs(direction[axis]) + (here[axis] != before[axis] ? 2.0 : 0.0);
        if (along <= most) continue;
        most = along;
        face.axis = axis;
        face.outward = direction[axis] > 0.0 ? -1 : 1;
      }
      return face;
    }
    before = here;
  }
  face.voxel = before;
  return face;
}

double sample(const GreyOctree& grey, const glm::dvec3& p) {
  const glm::dvec3 cell = glm::floor(p);
  const glm::dvec3 t = p - cell;
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 weight = glm::mix(1.0 - t, t, glm::dvec3(side));
    sum += weight.x * weight.y * weight.z * grey.sample(glm::ivec3(cell) + side);
  }
  return sum;
}

}  // namespace

glm::dvec3 context_normal(const Octree& octree, const glm::ivec3& voxel, int axis, int outward) {
  assert(axis >= 0 && axis < 3 && (outward == 1 || outward == -1));
  glm::dvec3 normal(0.0);
  normal[axis] = outward;
  for (int side = 0; side < 3; ++side) {
    if (side == axis) continue;
    const int rise = turn(octree, voxel, unit(axis, outward), unit(side, 1)) -
                     turn(octree, voxel, unit(axis, outward), unit(side, -1));
    normal[side] = -0.5 * rise;
  }
  return normal;
}

glm::dvec3 grey_normal(const GreyOctree& grey, const glm::dvec3& p_voxel) {
  glm::dvec3 normal;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 step(unit(axis, 1));
    normal[axis] = sample(grey, p_voxel - step) - sample(grey, p_voxel + step);
  }
  return normal;
}

std::vector<glm::vec3> object_normals(const DepthImage& image, const std::vector<DrawnObject>& objects,
                                      const ImagePlane& plane, ObjectNormals kind) {
  assert(!objects.empty() && image.size_px == plane.size_px);
  const Universe& universe = objects.front().octree.universe();
  const VoxelRays rays = voxel_rays(universe, plane);
  // The inverse transpose maps normals from index space to LPS, then to the view.
  const glm::dmat3 lps_from_normal = glm::transpose(glm::inverse(glm::dmat3(universe.lps_from_voxel)));
  const glm::dmat3 view_from_lps =
      glm::transpose(glm::dmat3(plane.view.right, plane.view.up, plane.view.look));
  const glm::dmat3 view_from_normal = view_from_lps * lps_from_normal;
  std::vector<glm::vec3> normals(image.pixels.size(), glm::vec3(0.0f));
  tbb::parallel_for(0, image.size_px.y, [&](int y) {
    for (int x = 0; x < image.size_px.x; ++x) {
      const Seen& seen = image.at(x, y);
      if (!seen.lit()) continue;
      const DrawnObject& object = objects[static_cast<std::size_t>(seen.object)];
      const glm::dvec2 p_px(x + 0.5, y + 0.5);
      const glm::dvec3 direction = rays.direction(p_px);
      const glm::dvec3 p = rays.start(p_px) + double(seen.depth_mm) * direction;
      glm::dvec3 normal(0.0);
      if (kind == ObjectNormals::Grey && object.grey && !seen.stepped) {
        const glm::dmat4 still_from_voxel = object.still_from_voxel().value_or(glm::dmat4(1.0));
        normal = glm::transpose(glm::dmat3(still_from_voxel)) *
                 grey_normal(*object.grey, glm::dvec3(still_from_voxel * glm::dvec4(p, 1.0)));
      }
      if (normal == glm::dvec3(0.0)) {
        const Face face = face_at(object.octree, p, direction);
        normal = context_normal(object.octree, face.voxel, face.axis, face.outward);
      }
      normals[pixel_index(image.size_px, x, y)] = glm::vec3(glm::normalize(view_from_normal * normal));
    }
  });
  return normals;
}

}  // namespace octotomy::voxel
