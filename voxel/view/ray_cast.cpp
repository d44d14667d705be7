// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/ray_cast.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <optional>
#include <tbb/parallel_for.h>

#include "voxel/view/parallel_rays.h"
#include "voxel/view/pixel_index.h"
#include "voxel/view/ray_surface.h"
#include "voxel/view/ray_walk.h"

// Pictures are cast square by square, all rays of a square together (parallel_rays.h); single rays walk one
// by one (ray_walk.h). Both visit the objects' voxels in their order along a ray. If an object has samples,
// its surface is sought near the voxel; otherwise it is the voxel's face.

namespace octotomy::voxel {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Prefetches a leaf's samples, two cache lines.
void prefetch_leaf(const GreyOctree& grey, const glm::ivec3& leaf) {
  const glm::ivec3 place = (leaf >> 2) & 3;
  const std::int16_t* samples =
      grey.brick(leaf >> 4).samples[static_cast<std::size_t>(child_index(place.x, place.y, place.z))].data();
  __builtin_prefetch(samples);
  __builtin_prefetch(samples + 32);
}

}  // namespace

struct RayCast::Prepared {
  std::vector<DrawnObject> objects;
  VoxelRays rays;
  std::optional<Eye> eye;
  Mirror mirror;                                     ///< of parallel rays
  std::vector<ParallelRays> bundles;                 ///< by object
  std::vector<std::optional<GreySurface>> surfaces;  ///< by object, of those that have their samples
  glm::ivec2 size_px{0};

  /// The depth by which a surface may lie in front of the voxel that led to it.
  static double reach_mm(const DrawnObject& object, const VoxelRay& ray) {
    return object.grey ? 2.0 / glm::length(ray.per_mm) : 0.0;
  }

  /// Updates `nearest` by the surface of object `i` near a voxel. False if there is none and the ray
  /// continues.
  bool take(std::size_t i, const VoxelRay& ray, const Mirror& frame, const Passage& passage,
            Seen& nearest) const {
    const DrawnObject& object = objects[i];
    if (nearest.lit() && passage.enter_mm > nearest.depth_mm + reach_mm(object, ray)) return true;
    std::optional<Seen> seen = Seen{static_cast<float>(passage.enter_mm), 0, true};
    if (surfaces[i]) seen = surfaces[i]->seen(ray, frame, passage);
    if (!seen) return false;
    seen->object = static_cast<std::int16_t>(i);
    if (seen->depth_mm < nearest.depth_mm) nearest = *seen;
    return true;
  }
};

RayCast::RayCast(const std::vector<DrawnObject>& objects, const ImagePlane& plane) {
  assert(!objects.empty());
  const Octree& first = objects.front().octree;
  const VoxelRays rays = voxel_rays(first.universe(), plane);
  auto prepared = std::make_shared<Prepared>(Prepared{
      objects, rays, plane.eye, Mirror(rays.per_mm, 1 << (2 * first.root_height())), {}, {}, plane.size_px});
  for (const DrawnObject& object : objects) {
    std::vector<ParallelRays>& bundles = prepared->bundles;
    if (!plane.eye)
      bundles.push_back(bundles.empty() ? ParallelRays(object.octree, rays)
                                        : bundles.front().through(object.octree));
    prepared->surfaces.push_back(object.grey ? std::optional<GreySurface>(object) : std::nullopt);
  }
  prepared_ = std::move(prepared);
}

Seen RayCast::seen(const glm::dvec2& p_px) const {
  return seen(p_px, -infinity, infinity);
}

Seen RayCast::seen(const glm::dvec2& p_px, double near_mm, double far_mm) const {
  const Prepared& the = *prepared_;
  const VoxelRay ray{the.rays.start(p_px), the.rays.direction(p_px)};
  const Mirror frame = the.eye ? Mirror(ray.per_mm, the.mirror.side) : the.mirror;
  const glm::dvec3 mirrored = frame.mirrored(ray.start);
  // The eye sees nothing behind itself.
  if (the.eye) near_mm = std::max(near_mm, the.eye->depth_mm());
  Seen nearest;
  for (std::size_t i = 0; i < the.objects.size(); ++i) {
    const DrawnObject& object = the.objects[i];
    // A voxel behind the nearest surface may have its own surface in front of it.
    const double until_mm =
        std::min(far_mm, static_cast<double>(nearest.depth_mm)) + the.reach_mm(object, ray);
    Walk(object.octree.root(), object.octree.root_height(), frame)
        .run(mirrored, near_mm, until_mm,
             [&](const Passage& passage) { return the.take(i, ray, frame, passage, nearest); });
  }
  return nearest;
}

DepthImage RayCast::picture() const {
  constexpr int square_px = ParallelRays::square_px;
  const Prepared& the = *prepared_;
  DepthImage image = unlit(the.size_px);
  const glm::ivec2 squares = (the.size_px + (square_px - 1)) / square_px;
  if (the.eye) {
    tbb::parallel_for(0, the.size_px.y, [&](int y) {
      for (int x = 0; x < the.size_px.x; ++x)
        image.pixels[pixel_index(the.size_px, x, y)] = seen({x + 0.5, y + 0.5});
    });
    return image;
  }
  tbb::parallel_for(0, squares.x * squares.y, [&](int square) {
    const glm::ivec2 first = glm::ivec2(square % squares.x, square / squares.x) * square_px;
    const glm::ivec2 last = glm::min(first + square_px, the.size_px) - 1;
    for (std::size_t i = 0; i < the.objects.size(); ++i) {
      ParallelRays::Announce fetch;
      if (the.objects[i].grey && !the.objects[i].moved_from_still)
        fetch = [&grey = *the.objects[i].grey](const glm::ivec3& leaf) { prefetch_leaf(grey, leaf); };
      const auto take = [&](const glm::ivec2& pixel, const Passage& passage) {
        const VoxelRay ray{the.rays.start(glm::dvec2(pixel) + 0.5), the.rays.per_mm};
        Seen& nearest = image.pixels[pixel_index(the.size_px, pixel.x, pixel.y)];
        return the.take(i, ray, the.mirror, passage, nearest);
      };
      the.bundles[i].cast(first, last, take, fetch);
    }
  });
  return image;
}

}  // namespace octotomy::voxel
