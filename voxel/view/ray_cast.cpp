// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/ray_cast.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <limits>
#include <optional>
#include <tbb/parallel_for.h>

#include "voxel/view/leaf_surface.h"
#include "voxel/view/parallel_rays.h"
#include "voxel/view/pixel_index.h"
#include "voxel/view/ray_surface.h"
#include "voxel/view/ray_walk.h"

// For pictures all rays of a square of pixels are cast together (parallel_rays.h); other rays walk one by one
// (ray_walk.h). Both visit the objects' voxels in their order along a ray. If an object has samples, its
// surface is searched for near the voxel; otherwise the surface is the voxel's face.

namespace octotomy::voxel {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Prefetches the samples of a leaf and of all leaves around it, two cache lines each.
void prefetch_leaf(const GreyOctree& grey, const glm::ivec3& leaf) {
  const int side = grey.universe().side();
  const glm::ivec3 first = glm::max(leaf - 4, glm::ivec3(0));
  const glm::ivec3 last = glm::min(leaf + 4, glm::ivec3(side - 4));
  for (int z = first.z; z <= last.z; z += 4)
    for (int y = first.y; y <= last.y; y += 4)
      for (int x = first.x; x <= last.x; x += 4) {
        const int number = child_index((x >> 2) & 3, (y >> 2) & 3, (z >> 2) & 3);
        const std::int16_t* samples =
            grey.brick({x >> 4, y >> 4, z >> 4}).samples[static_cast<std::size_t>(number)].data();
        __builtin_prefetch(samples);
        __builtin_prefetch(samples + 32);
      }
}

}  // namespace

struct RayCast::Prepared {
  std::vector<DrawnObject> objects;
  VoxelRays rays;
  std::optional<Eye> eye;
  Mirror mirror;                                     ///< used for parallel rays
  std::vector<ParallelRays> bundles;                 ///< by object
  std::vector<std::optional<GreySurface>> surfaces;  ///< one for each object; set if the object has samples
  glm::ivec2 size_px{0};

  /// The largest distance in depth by which a surface may lie in front of the voxel through which it was
  /// found.
  static double reach_mm(const DrawnObject& object, const glm::dvec3& per_mm) {
    return object.grey ? 2.0 / glm::length(per_mm) : 0.0;
  }

  /// The surface of object `i` near a voxel; none if the ray remains outside the surface.
  std::optional<Seen> surface_near(std::size_t i, const VoxelRay& ray, const Mirror& frame,
                                   const Passage& passage) const {
    if (!surfaces[i]) return Seen{static_cast<float>(passage.enter_mm), 0, true};
    return surfaces[i]->seen(ray, frame, passage);
  }

  /// Whether a voxel is so far behind the nearest surface that its own surface cannot be nearer.
  static bool is_behind(double enter_mm, double reach_mm, const Seen& nearest) {
    return nearest.lit() && enter_mm > nearest.depth_mm + reach_mm;
  }
  static void take_nearer(const Seen& seen, Seen& nearest) {
    if (seen.depth_mm < nearest.depth_mm) nearest = seen;
  }

  /// The pixels of a square, row by row.
  using Square = std::array<Seen, std::size_t{ParallelRays::square_px} * ParallelRays::square_px>;
  void cast_square(std::size_t i, const glm::ivec2& first, const glm::ivec2& last, Square& square) const;
  RayBatch::Rays take(std::size_t i, const RayBatch& batch, const LeafSurface::Found& found,
                      const glm::ivec2& first, Square& square) const;
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

/// Stores the surfaces of object `i`, computed near the voxels of a batch, in a square if they are the
/// nearest. Returns the rays that end, at a surface or farther than the reach behind the nearest surface.
RayBatch::Rays RayCast::Prepared::take(std::size_t i, const RayBatch& batch, const LeafSurface::Found& found,
                                       const glm::ivec2& first, Square& square) const {
  const auto pixel_of = [&](int ray) -> Seen& {
    const auto number = static_cast<std::size_t>(ray);
    return square[pixel_index(glm::ivec2(ParallelRays::square_px), batch.x[number] - first.x,
                              batch.y[number] - first.y)];
  };
  RayBatch::Rays behind = 0;
  if (i > 0) {
    const double reach = reach_mm(objects[i], rays.per_mm);
    for (int ray = 0; ray < batch.count; ++ray) {
      const double enter_mm = batch.enter_mm[static_cast<std::size_t>(ray)];
      behind |= RayBatch::Rays{is_behind(enter_mm, reach, pixel_of(ray))} << ray;
    }
  }
  for (RayBatch::Rays rest = found.lit & ~behind; rest != 0; rest &= rest - 1) {
    const int ray = std::countr_zero(rest);
    take_nearer({found.depth_mm[static_cast<std::size_t>(ray)], static_cast<std::int16_t>(i),
                 ((found.stepped >> ray) & 1) != 0},
                pixel_of(ray));
  }
  return found.lit | behind;
}

/// Casts the rays of a square of pixels through object `i`. Each ray ends at the object's nearest surface.
void RayCast::Prepared::cast_square(std::size_t i, const glm::ivec2& first, const glm::ivec2& last,
                                    Square& square) const {
  const DrawnObject& object = objects[i];
  LeafSurface::Found found;
  if (!object.grey) {
    bundles[i].cast(first, last, [&](const RayBatch& batch) {
      std::copy_n(batch.enter_mm.begin(), batch.count, found.depth_mm.begin());
      found.lit = found.stepped = RayBatch::all(batch.count);
      return take(i, batch, found, first, square);
    });
    return;
  }
  LeafSurface surface(object, rays.per_mm, mirror);
  const auto take_all = [&](const RayBatch& batch) {
    surface.find(batch, found);
    return take(i, batch, found, first, square);
  };
  if (object.moved_from_still) return bundles[i].cast(first, last, take_all);
  bundles[i].cast(first, last, take_all, [&](const glm::ivec3& leaf) { prefetch_leaf(*object.grey, leaf); });
}

Seen RayCast::seen(const glm::dvec2& p_px) const {
  return seen(p_px, -infinity, infinity);
}

Seen RayCast::seen(const glm::dvec2& p_px, double near_mm, double far_mm) const {
  const Prepared& the = *prepared_;
  const VoxelRay ray{the.rays.start(p_px), the.rays.direction(p_px)};
  const Mirror frame = the.eye ? Mirror(ray.per_mm, the.mirror.side) : the.mirror;
  const glm::dvec3 mirrored = frame.mirrored(ray.start);
  // Surfaces behind the eye are not visible.
  if (the.eye) near_mm = std::max(near_mm, the.eye->depth_mm());
  Seen nearest;
  for (std::size_t i = 0; i < the.objects.size(); ++i) {
    const DrawnObject& object = the.objects[i];
    // The surface of a voxel may be up to the reach in front of the voxel, so it may be the nearest although
    // the voxel is not.
    const double reach_mm = the.reach_mm(object, ray.per_mm);
    const double until_mm = std::min(far_mm, static_cast<double>(nearest.depth_mm)) + reach_mm;
    Walk(object.octree.root(), object.octree.root_height(), frame)
        .run(mirrored, near_mm, until_mm, [&](const Passage& passage) {
          if (the.is_behind(passage.enter_mm, reach_mm, nearest)) return true;
          std::optional<Seen> seen = the.surface_near(i, ray, frame, passage);
          if (!seen) return false;
          seen->object = static_cast<std::int16_t>(i);
          the.take_nearer(*seen, nearest);
          return true;
        });
  }
  return nearest;
}

DepthImage RayCast::picture() const {
  constexpr int square_px = ParallelRays::square_px;
  const Prepared& the = *prepared_;
  DepthImage image = unset(the.size_px);
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
    Prepared::Square seen_in_square;
    for (std::size_t i = 0; i < the.objects.size(); ++i) the.cast_square(i, first, last, seen_in_square);
    for (int y = first.y; y <= last.y; ++y)
      std::copy_n(&seen_in_square[static_cast<std::size_t>((y - first.y) * square_px)], last.x - first.x + 1,
                  &image.pixels[pixel_index(the.size_px, first.x, y)]);
  });
  return image;
}

}  // namespace octotomy::voxel
